//! Which vertices have a *clear* star: of its faces no two primitives without a common vertex are within the margin.
//! Pairs of faces that share the centre of a clear star need no other test.

use std::ops::Range;

use crate::{
    intersect::{Bvh, MAX_ADJACENT_FACES, OneRings, clear_mask_x8, is_clear},
    mesh::{Mesh, VertexId},
    simd::{InstructionSet, Task},
};

/// What is known of the star of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Star {
    /// Nothing in it is within the margin.
    Clear,
    /// Something may be.
    Open,
    /// It has so many faces that pairs of them are not listed, but found by their boxes.
    Hub,
}

/// The stars of all vertices.
#[derive(Debug, Default)]
pub(super) struct Stars {
    pub(super) rings: OneRings,
    states: Vec<Star>,
    /// Those that no test is made for: of few faces, or not a simple fan.
    untested: Vec<VertexId>,
    /// All open ones of this frame, the untested first.
    pub(super) open: Vec<VertexId>,
}

impl Stars {
    /// The stars of a mesh. Cost: O(n log n) in the faces.
    pub(super) fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let rings = OneRings::new(mesh, bvh.faces());
        let mut stars = Self { states: vec![Star::Clear; mesh.num_vertices()], rings, ..Self::default() };
        let mut is_tested = vec![false; mesh.num_vertices()];
        for ring in (0..stars.rings.len()).map(|ring| stars.rings.get(ring)) {
            is_tested[ring.centre.index()] = !ring.around.is_empty();
        }
        for vertex in mesh.vertex_ids().filter(|&vertex| !mesh.is_body(vertex)) {
            let num_faces = mesh.vertex_faces(vertex).len();
            if num_faces > MAX_ADJACENT_FACES {
                stars.states[vertex.index()] = Star::Hub;
            } else if num_faces > 1 && !is_tested[vertex.index()] {
                stars.untested.push(vertex);
            }
        }
        stars
    }

    /// Starts a search: only untested stars are open.
    pub(super) fn begin(&mut self) {
        for vertex in self.open.drain(..) {
            self.states[vertex.index()] = Star::Clear;
        }
        let untested = std::mem::take(&mut self.untested);
        self.open(&untested);
        self.untested = untested;
    }

    /// Takes stars as open.
    pub(super) fn open(&mut self, centres: &[VertexId]) {
        for &centre in centres {
            let state = &mut self.states[centre.index()];
            if *state != Star::Hub {
                *state = Star::Open;
                self.open.push(centre);
            }
        }
    }

    /// Whether a pair of faces is to be tested in this open star: all vertices that they share are centres of open
    /// stars, and this one is the first.
    #[inline(always)]
    pub(super) fn has_pair(&self, centre: VertexId, [first, second]: [[VertexId; 3]; 2]) -> bool {
        first.into_iter().filter(|corner| second.contains(corner)).all(|shared| match self.states[shared.index()] {
            Star::Clear => false,
            Star::Open => centre <= shared,
            Star::Hub => true,
        })
    }
}

/// Finds open stars, by ranges of the batches of one-rings and of those in no batch.
pub(super) struct TestStars<'a> {
    pub(super) bvh: &'a Bvh,
    pub(super) rings: &'a OneRings,
    pub(super) margin: f32,
    pub(super) batches: Range<usize>,
    pub(super) unbatched: Range<usize>,
    pub(super) spokes: &'a mut Vec<[f64; 2]>,
    pub(super) open: &'a mut Vec<VertexId>,
}

impl Task for TestStars<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(mut self, simd: S) {
        let points = self.bvh.points_f32();
        for batch in self.batches.clone() {
            let rings = self.rings.batch(batch);
            let mut left = !clear_mask_x8(simd.f32x8(), points, &rings, self.margin) & 0xff;
            if self.bvh.has_far() {
                left |= self.bvh.far_lanes(rings.around.iter().chain([rings.centres]));
            }
            while left != 0 {
                self.test(rings.numbers[left.trailing_zeros() as usize]);
                left &= left - 1;
            }
        }
        for &ring in &self.rings.unbatched()[self.unbatched.clone()] {
            self.test(ring);
        }
    }
}

impl TestStars<'_> {
    /// Tests a star in double precision.
    fn test(&mut self, ring: u32) {
        let ring = self.rings.get(ring as usize);
        if ring.around.is_empty() || ring.around.len() > MAX_ADJACENT_FACES + 1 {
            return;
        }
        let is_near = || ring.around.iter().chain([&ring.centre]).all(|vertex| !self.bvh.is_far(vertex.0));
        if !(is_near() && is_clear(self.bvh.points_f32(), ring, self.margin, self.spokes)) {
            self.open.push(ring.centre);
        }
    }
}
