//! From a frame to its sorted intersections.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    Intersections, Segment, SegmentEnd,
    broad::{FaceTree, NodePair},
    lanes::{Lanes, Task, dispatch},
    locate::locate,
    narrow::{Contact, Crossing, Fan, contact, share_a_vertex},
    separate::are_apart,
    umbrella::Umbrella,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// Subtrees into which the search is split, at least, where the tree has as many.
const NUM_SUBTREES: usize = 16;

/// Vertices whose surroundings are searched in one go.
const FANS_OF_PART: usize = 1024;

/// What one part of the search found, with the memory that it needs.
#[derive(Debug, Default)]
struct Part {
    stack: Vec<NodePair>,
    umbrella: Umbrella,
    fan: Fan,
    contacts: Vec<([FaceId; 2], Contact)>,
}

/// One part of the search: two subtrees, or a range of rings.
struct Search<'a, T> {
    part: &'a mut Part,
    tree: &'a FaceTree,
    mesh: &'a Mesh,
    frame: &'a Frame,
    what: T,
}

impl Task for Search<'_, NodePair> {
    /// Tests the pairs of two subtrees.
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { part: Part { stack, contacts, .. }, tree, mesh, frame, what } = self;
        let triangle = |place| tree.corners(place).map(|corner| frame.position(corner).into());
        tree.search(lanes, what, stack, |places| {
            if are_apart(&triangle(places[0]), &triangle(places[1])) {
                return;
            }
            let [a, b] = places.map(|place| tree.face(place));
            if tree.misses_neighbours() && share_a_vertex(mesh, [a, b]) {
                return;
            }
            if let Some(contact) = contact(mesh, frame, [a, b]) {
                contacts.push((if a < b { [a, b] } else { [b, a] }, contact));
            }
        });
    }
}

impl Task for Search<'_, Range<usize>> {
    /// Tests the pairs of faces round vertices, which always touch.
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { part: Part { umbrella, fan, contacts, .. }, tree, mesh, frame, what } = self;
        for ring in what.map(|ring| tree.rings().get(ring)) {
            if !umbrella.is_open(frame, ring) {
                fan.contacts(mesh, frame, ring.centre, &mut |faces, contact| contacts.push((faces, contact)));
            }
        }
    }
}

/// Finds all intersections of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Intersector {
    tree: FaceTree,
    subtrees: Vec<NodePair>,
    /// So that the parts can be searched side by side.
    parts: Vec<Part>,
    contacts: Vec<([FaceId; 2], Contact)>,
    crossings: Vec<Crossing>,
    /// Scratch of the check in debug builds.
    #[cfg(debug_assertions)]
    num_segments: Vec<usize>,
}

impl Intersector {
    /// Finds all intersections of `frame`.
    ///
    /// The answer is complete and exact: the same as that of testing every edge against every face. It does not depend on the
    /// number of threads.
    ///
    /// # Panics
    /// If the signs contradict each other, which consistent perturbation rules out.
    ///
    /// Pairs of faces that share a vertex come from the topology, which is fixed; all others from a tree of boxes.
    ///
    /// Cost: O(n log n) for n faces of bounded overlap and bounded numbers round a vertex, plus O(k log k) for k intersecting pairs.
    pub fn intersect(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.tree.fit(mesh, frame);
        self.tree.parts(NUM_SUBTREES, &mut self.subtrees);
        let num_fans = self.tree.rings().len().div_ceil(FANS_OF_PART);
        let num_parts = self.subtrees.len() + num_fans;
        if self.parts.len() < num_parts {
            self.parts.resize_with(num_parts, Part::default);
        }
        let (apart, round_vertices) = self.parts[..num_parts].split_at_mut(self.subtrees.len());
        let tree = &self.tree;
        rayon::join(
            || {
                self.subtrees.par_iter().zip(apart).for_each(|(&subtrees, part)| {
                    part.contacts.clear();
                    dispatch(Search { part, tree, mesh, frame, what: subtrees });
                });
            },
            || {
                round_vertices.par_iter_mut().enumerate().for_each(|(index, part)| {
                    part.contacts.clear();
                    let first = index * FANS_OF_PART;
                    let rings = first..(first + FANS_OF_PART).min(tree.rings().len());
                    dispatch(Search { part, tree, mesh, frame, what: rings });
                });
            },
        );
        self.contacts.clear();
        for part in &self.parts[..num_parts] {
            self.contacts.extend_from_slice(&part.contacts);
        }
        self.contacts.sort_unstable_by_key(|&(faces, _)| faces);
        self.assemble(mesh, frame, found);
    }

    /// Numbers the crossings, each of which belongs to all pairs round its edge, and refers the segments to them.
    fn assemble(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.crossings.clear();
        for (_, contact) in &self.contacts {
            match *contact {
                Contact::Crossings(crossings) => self.crossings.extend(crossings),
                Contact::FromLoopVertex(crossing, _) => self.crossings.push(crossing),
            }
        }
        self.crossings.sort_unstable();
        self.crossings.dedup();
        found.edge_face.clear();
        found.edge_face.extend(self.crossings.iter().map(|&crossing| locate(mesh, frame, crossing)));

        #[cfg(debug_assertions)]
        self.assert_every_crossing_joins_all_faces(mesh);

        let crossings = &self.crossings;
        let end_at = |crossing: Crossing| {
            let index = crossings.binary_search(&crossing).expect("every crossing was collected above");
            SegmentEnd::EdgeFace(u32::try_from(index).expect("fewer crossings than 2^32"))
        };
        found.segments.clear();
        found.segments.extend(self.contacts.iter().map(|&(faces, contact)| {
            let ends = match contact {
                Contact::Crossings([a, b]) => [end_at(a.min(b)), end_at(a.max(b))],
                Contact::FromLoopVertex(crossing, vertex) => [end_at(crossing), SegmentEnd::LoopVertex(vertex)],
            };
            Segment { faces, ends }
        }));
    }
    /// A crossing of an edge ends one segment for each face of the edge: with fewer a chain would end in the middle of the cloth.
    #[cfg(debug_assertions)]
    fn assert_every_crossing_joins_all_faces(&mut self, mesh: &Mesh) {
        let num_segments = &mut self.num_segments;
        num_segments.clear();
        num_segments.resize(self.crossings.len(), 0);
        for (faces, contact) in &self.contacts {
            let ends = match *contact {
                Contact::Crossings(crossings) => crossings,
                Contact::FromLoopVertex(crossing, _) => [crossing; 2],
            };
            let count = if ends[0] == ends[1] { 1 } else { 2 };
            for crossing in &ends[..count] {
                let place = self.crossings.binary_search(crossing);
                num_segments[place.expect("every crossing was collected above")] += 1;
                assert!(faces.contains(&crossing.1), "a crossing of face {} between others", crossing.1.0);
            }
        }
        for (&(edge, face), &mut count) in self.crossings.iter().zip(num_segments) {
            let expected = mesh.edge_faces(edge).len();
            assert_eq!(count, expected, "segments that end where edge {} pierces face {}", edge.0, face.0);
        }
    }
}
