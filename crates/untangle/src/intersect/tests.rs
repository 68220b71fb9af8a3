//! The filters against exact signs, on input where the signs are close.

use super::{
    bvh::{Bvh, WIDTH},
    exact::{VertexStar, contact_of_disjoint},
    filter::{OneRings, VertexStarFilter, are_separated, injective_mask_x8, separated_mask_x8},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, MeshDescription},
    simd::{InstructionSet, Portable, Task, dispatch},
};

/// Numbers on a coarse grid, some of them off it by very little, so that much is degenerate or nearly so.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    #[allow(clippy::cast_precision_loss, reason = "small numbers")]
    fn coordinate(&mut self) -> f64 {
        let on_grid = 0.1 * self.below(6) as f64;
        if self.below(3) == 0 { on_grid * (1.0 + f64::EPSILON * self.below(4) as f64) } else { on_grid }
    }

    fn point(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.coordinate())
    }
}

#[test]
fn separating_axis_of_intersecting_triangles_is_never_found() {
    let faces = vec![[0, 1, 2], [3, 4, 5]];
    let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
    let mut numbers = Numbers(1);
    let mut counts = [0; 3];
    for _ in 0..50_000 {
        let positions: Vec<_> = (0..6).map(|_| numbers.point()).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let (a, b) = ([0, 1, 2].map(|k| positions[k]), [3, 4, 5].map(|k| positions[k]));
        let intersects = contact_of_disjoint(&mesh, &frame, [FaceId(0), FaceId(1)]).is_some();
        let is_proven = are_separated(&a, &b);
        assert!(!(intersects && is_proven), "{positions:?}");
        counts[if intersects { 0 } else { 1 + usize::from(is_proven) }] += 1;
    }
    // Each of the three cases occurs: intersecting, not proven, proven.
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}

/// The filters in single precision, behind an instruction set that is not named.
trait AnySet {
    fn separated(&self, bvh: &Bvh, corners: &[[[u32; WIDTH]; 3]; 2]) -> u32;
    fn injective(&self, bvh: &Bvh, one_rings: &OneRings, batch: usize) -> u32;
}

impl<S: InstructionSet> AnySet for S {
    fn separated(&self, bvh: &Bvh, corners: &[[[u32; WIDTH]; 3]; 2]) -> u32 {
        separated_mask_x8(self.f32x8(), bvh.points_f32(), corners, 0) & !bvh.far_lanes(corners.iter().flatten())
    }

    fn injective(&self, bvh: &Bvh, one_rings: &OneRings, batch: usize) -> u32 {
        let rings = one_rings.batch(batch);
        let far = bvh.far_lanes(rings.around.iter().chain([rings.centres]));
        injective_mask_x8(self.f32x8(), bvh.points_f32(), &rings) & !far
    }
}

/// The answer of a filter, which has to be the same for all instruction sets.
fn by_all_sets(filter: &dyn Fn(&dyn AnySet) -> u32) -> u32 {
    struct Run<'a>(&'a dyn Fn(&dyn AnySet) -> u32, &'a mut u32);
    impl Task for Run<'_> {
        fn run<S: InstructionSet>(self, simd: S) {
            *self.1 = (self.0)(&simd);
        }
    }
    let mut best = 0;
    dispatch(Run(filter, &mut best));
    assert_eq!(filter(&Portable), best);
    best
}

#[test]
fn separating_axis_x8_of_intersecting_triangles_is_never_found() {
    let faces: Vec<_> = (0..16).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices: 48, faces, ..Default::default() }).unwrap();
    let mut numbers = Numbers(3);
    let mut bvh = Bvh::default();
    let corners: [[[u32; WIDTH]; 3]; 2] = std::array::from_fn(|triangle| {
        std::array::from_fn(|corner| {
            std::array::from_fn(|pair| u32::try_from(3 * (2 * pair + triangle) + corner).unwrap())
        })
    });
    let mut counts = [0; 3];
    for round in 0..6_000 {
        // Where gaps are small compared with the whole, single precision resolves few of them.
        let size = [1.0, 1e-3, 1e-6][round % 3];
        let positions: Vec<[f64; 3]> =
            (0..48).map(|k| numbers.point().map(|x| if k == 0 { x } else { 1.0 + size * x })).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        bvh.prepare(&mesh, &frame);
        bvh.refit(&mesh, &frame);
        let separated = by_all_sets(&|simd| simd.separated(&bvh, &corners));
        for pair in 0..8 {
            let faces = [2 * pair, 2 * pair + 1];
            let intersects = contact_of_disjoint(&mesh, &frame, faces.map(FaceId)).is_some();
            let is_proven = separated >> pair & 1 == 1;
            assert!(!(intersects && is_proven), "{faces:?} {positions:?}");
            counts[if intersects { 0 } else { 1 + usize::from(is_proven) }] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}

/// Eight separate vertex stars.
struct Stars {
    mesh: Mesh,
    num_spokes: u32,
    closed: bool,
}

impl Stars {
    fn new(num_spokes: u32, closed: bool) -> Self {
        let num_vertices = num_spokes + 1;
        let mut faces = Vec::new();
        for centre in (0..8).map(|star| star * num_vertices) {
            faces.extend((1..num_spokes).map(|k| [centre, centre + k, centre + k + 1]));
            if closed {
                faces.push([centre, centre + num_spokes, centre + 1]);
            }
        }
        let num_vertices = 8 * num_vertices as usize;
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
        Self { mesh, num_spokes, closed }
    }

    /// Spokes that turn around the centre `turns` times, off by so much that some fold over; or anywhere on a grid.
    fn positions(&self, numbers: &mut Numbers, turns: f64) -> Vec<[f64; 3]> {
        let num_vertices = self.num_spokes + 1;
        let position = |k: u32| {
            let k = k % num_vertices;
            if k == 0 || turns < 1.0 {
                return numbers.point();
            }
            let angle = std::f64::consts::TAU * turns * f64::from(k) / f64::from(self.num_spokes);
            let [x, y, z] = numbers.point();
            [0.25 + 0.4 * angle.cos() + 0.6 * x, 0.25 + 0.4 * angle.sin() + 0.6 * y, z]
        };
        (0..8 * num_vertices).map(position).collect()
    }

    /// Counts stars that intersect, are not proven, are proven in double precision, and are proven in single precision.
    fn check(&self, positions: &[[f64; 3]], counts: &mut [usize; 4]) {
        let frame = Frame::new(&self.mesh, positions).unwrap();
        let mut bvh = Bvh::default();
        bvh.prepare(&self.mesh, &frame);
        bvh.refit(&self.mesh, &frame);
        let rings = OneRings::new(&self.mesh, bvh.faces());
        assert_eq!((rings.len(), rings.num_batches()), (8, usize::from(self.closed)));
        let in_single = if self.closed { by_all_sets(&|simd| simd.injective(&bvh, &rings, 0)) } else { 0 };
        let (mut filter, mut star) = (VertexStarFilter::default(), VertexStar::default());
        for number in 0..8 {
            let ring = rings.get(number);
            assert_eq!(ring.around.len(), self.num_spokes as usize + usize::from(self.closed));
            let is_injective = filter.clearance_m(&frame, ring) > 0.0;
            let lane = || rings.batch(0).numbers.iter().position(|&of| of as usize == number).unwrap();
            let is_injective_in_single = self.closed && in_single >> lane() & 1 == 1;
            let mut intersects = false;
            star.load(&self.mesh, &frame, ring.centre);
            star.test(&self.mesh, usize::MAX, &mut |_, _| intersects = true);
            let is_proven = is_injective || is_injective_in_single;
            assert!(!(intersects && is_proven), "{} spokes, {number}: {positions:?}", self.num_spokes);
            counts[if intersects { 0 } else { 1 + usize::from(is_injective) }] += 1;
            counts[3] += usize::from(is_injective_in_single);
        }
    }
}

#[test]
fn vertex_star_with_a_crossing_is_never_found_injective() {
    let mut counts = [0; 4];
    let mut numbers = Numbers(2);
    for (num_spokes, closed) in
        [(4, true), (5, true), (6, true), (7, true), (9, true), (4, false), (6, false), (8, false)]
    {
        let stars = Stars::new(num_spokes, closed);
        for turns in [1.0, 1.0, 1.0, 2.0, 0.7] {
            for round in 0..300 {
                let mut positions = stars.positions(&mut numbers, turns);
                for position in &mut positions[1..] {
                    *position = position.map(|x| 1.0 + [1.0, 1e-6][round % 2] * x);
                }
                stars.check(&positions, &mut counts);
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}
