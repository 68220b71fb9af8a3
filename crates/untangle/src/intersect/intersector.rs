//! From a frame to its sorted intersections.

use rayon::prelude::*;

use super::{
    Intersections, Segment, SegmentEnd,
    broad::{FaceTree, NodePair},
    coherence::{Coherence, Mode, PAIRS_OF_GROUP, RINGS_OF_GROUP},
    lanes::dispatch,
    locate::locate,
    narrow::{Contact, Crossing},
    search::{AllLeaves, KeptPairs, KeptRings, Part, Search, SomeRings, SomeSubtrees},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// Subtrees into which the search is split, at least, where the tree has as many.
const NUM_SUBTREES: usize = 16;

/// Shares of the search through subtrees. Neighbours in their list go to different shares: those at its start, subtrees against themselves,
/// take far longer than two that hardly meet.
const NUM_SHARES: usize = 32;

/// Vertices whose surroundings are searched in one go.
const FANS_OF_PART: usize = 1024;

/// Pairs of leaves that are looked through in one go.
const PAIRS_OF_PART: usize = 1024;

/// Finds all intersections of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Intersector {
    tree: FaceTree,
    subtrees: Vec<NodePair>,
    /// So that the parts can be searched side by side.
    parts: Vec<Part>,
    coherence: Coherence,
    kept_parts: Vec<Part>,
    stack: Vec<NodePair>,
    contacts: Vec<([FaceId; 2], Contact)>,
    /// Each with a segment that ends there, and which end it is.
    crossings: Vec<(Crossing, usize, usize)>,
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
        if self.tree.prepare(mesh, frame) {
            self.coherence.reset(&self.tree);
        }
        self.contacts.clear();
        match self.coherence.advance(mesh, frame) {
            Mode::Cold => self.search(mesh, frame),
            Mode::Anew => {
                self.tree.fit(frame);
                let Self { tree, coherence, stack, .. } = self;
                let margin_m = coherence.margin_m();
                dispatch(AllLeaves { tree, margin_m, stack, pairs: &mut coherence.pairs });
                self.search_kept(mesh, frame);
            }
            Mode::Kept => self.search_kept(mesh, frame),
        }
        self.contacts.sort_unstable_by_key(|&(faces, _)| faces);
        self.assemble(mesh, frame, found);
    }

    /// Forgets the last frame, so that the next one is searched from nothing: for measuring, since answers never depend on what came before.
    pub fn forget(&mut self) {
        self.coherence.forget();
    }

    /// All contacts, from nothing.
    fn search(&mut self, mesh: &Mesh, frame: &Frame) {
        self.tree.fit(frame);
        self.tree.parts(NUM_SUBTREES, &mut self.subtrees);
        let num_fans = self.tree.rings().len().div_ceil(FANS_OF_PART);
        let num_shares = NUM_SHARES.min(self.subtrees.len());
        let num_parts = num_shares + num_fans;
        if self.parts.len() < num_parts {
            self.parts.resize_with(num_parts, Part::default);
        }
        let (apart, round_vertices) = self.parts[..num_parts].split_at_mut(num_shares);
        let (tree, subtrees) = (&self.tree, &self.subtrees);
        rayon::join(
            || {
                apart.par_iter_mut().with_max_len(1).enumerate().for_each(|(first, part)| {
                    part.contacts.clear();
                    let what = SomeSubtrees { all: subtrees, first, step: num_shares };
                    dispatch(Search { part, tree, mesh, frame, what });
                });
            },
            || {
                round_vertices.par_iter_mut().enumerate().for_each(|(index, part)| {
                    part.contacts.clear();
                    let share = |count: usize| index * count / num_fans..(index + 1) * count / num_fans;
                    let rings = tree.rings();
                    let what = SomeRings { eights: share(rings.num_eights()), others: share(rings.others().len()) };
                    dispatch(Search { part, tree, mesh, frame, what });
                });
            },
        );
        for part in &self.parts[..num_parts] {
            self.contacts.extend_from_slice(&part.contacts);
        }
    }

    /// All contacts, looking only where proofs of earlier frames have run out.
    fn search_kept(&mut self, mesh: &Mesh, frame: &Frame) {
        let tree = &self.tree;
        let margin_m = self.coherence.margin_m();
        let kept = self.coherence.parts();
        let num_apart = kept.pairs.len().div_ceil(PAIRS_OF_PART);
        let num_parts = num_apart + kept.rings_until.len().div_ceil(FANS_OF_PART);
        if self.kept_parts.len() < num_parts {
            self.kept_parts.resize_with(num_parts, Part::default);
        }
        let (apart, round_vertices) = self.kept_parts[..num_parts].split_at_mut(num_apart);
        let (clocks, latest) = (kept.regions, kept.latest);
        rayon::join(
            || {
                let pairs = kept.pairs.par_chunks_mut(PAIRS_OF_PART);
                let first = kept.first_of_pairs.par_chunks_mut(PAIRS_OF_PART / PAIRS_OF_GROUP);
                pairs.zip(first).zip(apart).for_each(|((pairs, first), part)| {
                    part.contacts.clear();
                    let what = KeptPairs { pairs, first, clocks, latest, margin_m };
                    dispatch(Search { part, tree, mesh, frame, what });
                });
            },
            || {
                let rings = kept.rings_until.par_chunks_mut(FANS_OF_PART);
                let first = kept.first_of_rings.par_chunks_mut(FANS_OF_PART / RINGS_OF_GROUP);
                let clocks = kept.groups.par_chunks(FANS_OF_PART / RINGS_OF_GROUP);
                let shares = rings.zip(first).zip(clocks).zip(round_vertices).enumerate();
                shares.for_each(|(index, (((rings_until, first), clocks), part))| {
                    part.contacts.clear();
                    let what = KeptRings { start: index * FANS_OF_PART, rings_until, first, clocks };
                    dispatch(Search { part, tree, mesh, frame, what });
                });
            },
        );
        for part in &self.kept_parts[..num_parts] {
            self.contacts.extend_from_slice(&part.contacts);
        }
    }

    /// Numbers the crossings, each of which belongs to all pairs round its edge, and refers the segments to them.
    fn assemble(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.crossings.clear();
        found.segments.clear();
        for &(faces, contact) in &self.contacts {
            let segment = found.segments.len();
            // Their numbers follow.
            let mut ends = [SegmentEnd::EdgeFace(u32::MAX); 2];
            match contact {
                Contact::Crossings([a, b]) => self.crossings.extend([(a.min(b), segment, 0), (a.max(b), segment, 1)]),
                Contact::FromLoopVertex(crossing, vertex) => {
                    self.crossings.push((crossing, segment, 0));
                    ends[1] = SegmentEnd::LoopVertex(vertex);
                }
            }
            found.segments.push(Segment { faces, ends });
        }
        self.crossings.sort_unstable();
        found.edge_face.clear();
        for alike in self.crossings.chunk_by(|a, b| a.0 == b.0) {
            let number = u32::try_from(found.edge_face.len()).expect("fewer crossings than 2^32");
            found.edge_face.push(locate(mesh, frame, alike[0].0));
            for &(_, segment, end) in alike {
                found.segments[segment].ends[end] = SegmentEnd::EdgeFace(number);
            }
        }
        #[cfg(debug_assertions)]
        self.assert_every_crossing_joins_all_faces(mesh, found);
    }

    /// A crossing of an edge ends one segment for each face of the edge: with fewer a chain would end in the middle of the cloth.
    #[cfg(debug_assertions)]
    fn assert_every_crossing_joins_all_faces(&mut self, mesh: &Mesh, found: &Intersections) {
        let num_segments = &mut self.num_segments;
        num_segments.clear();
        num_segments.resize(found.edge_face.len(), 0);
        for Segment { faces, ends } in &found.segments {
            let count = if ends[0] == ends[1] { 1 } else { 2 };
            for end in &ends[..count] {
                let SegmentEnd::EdgeFace(number) = *end else { continue };
                let face = found.edge_face[number as usize].face;
                num_segments[number as usize] += 1;
                assert!(faces.contains(&face), "a crossing of face {} between others", face.0);
            }
        }
        for (crossing, &mut count) in found.edge_face.iter().zip(num_segments) {
            let (edge, face) = (crossing.edge, crossing.face);
            let expected = mesh.edge_faces(edge).len();
            assert_eq!(count, expected, "segments that end where edge {} pierces face {}", edge.0, face.0);
        }
    }
}
