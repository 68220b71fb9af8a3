//! From segments to chains, with both sheets followed along the chain.
//!
//! An edge-face intersection `(e, T)` joins the segments `{F, T}` of all faces `F` of `e`: two inside of a sheet, one
//! where `e` is on the boundary, and more at a non-manifold edge, where chains are split. The copy that lies in `T`
//! stays in `T`; the other crosses `e`. A loop vertex ends each of its segments separately, so that chains are never
//! ambiguous, however many meet in one vertex.

use std::ops::Range;

use crate::{
    intersect::{Intersections, SegmentEnd},
    mesh::FaceId,
    stage::Pace,
};

/// Work of tracing one step, in the units of a pace.
const WORK_PER_STEP: usize = 8;

/// One segment of a chain with the faces of both copies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) faces: [FaceId; 2],
}

/// A connected run of segments.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    /// In [`Chains::steps`].
    pub(crate) steps: Range<usize>,
    /// In [`Chains::nodes`]: one more than steps; a closed chain repeats its first node.
    pub(crate) nodes: Range<usize>,
    pub(crate) closed: bool,
    /// A closed chain whose copies have exchanged their sheets after one round: one path of two rounds.
    pub(crate) twisted: bool,
}

/// All chains of a frame.
#[derive(Debug, Default)]
pub(crate) struct Chains {
    pub(crate) chains: Vec<Chain>,
    pub(crate) steps: Vec<Step>,
    pub(crate) nodes: Vec<SegmentEnd>,
    /// For each edge-face intersection the first two segments that end there.
    links: Vec<[u32; 2]>,
    /// For each edge-face intersection the number of segments that end there.
    degrees: Vec<u32>,
    visited: Vec<bool>,
}

impl Chains {
    /// Traces all chains, in the order of their lowest segments; false where time is up before. Cost: linear in the
    /// segments.
    pub(crate) fn trace(&mut self, found: &Intersections, pace: &mut Pace<'_>) -> bool {
        self.link(found);
        self.chains.clear();
        self.steps.clear();
        self.nodes.clear();
        self.visited.clear();
        self.visited.resize(found.segments.len(), false);
        for seed in 0..u32::try_from(found.segments.len()).expect("fewer than 2^32 segments") {
            if !self.visited[seed as usize] {
                let before = self.steps.len();
                self.trace_from(found, seed);
                if pace.is_spent_after(WORK_PER_STEP * (self.steps.len() - before)) {
                    return false;
                }
            }
        }
        true
    }

    /// Lists the segments that end in each edge-face intersection.
    fn link(&mut self, found: &Intersections) {
        self.links.clear();
        self.links.resize(found.edge_face.len(), [0; 2]);
        self.degrees.clear();
        self.degrees.resize(found.edge_face.len(), 0);
        for (segment, ends) in (0u32..).zip(found.segments.iter().map(|segment| segment.ends)) {
            for end in ends {
                if let SegmentEnd::EdgeFace(crossing) = end {
                    let degree = &mut self.degrees[crossing as usize];
                    if let Some(slot) = self.links[crossing as usize].get_mut(*degree as usize) {
                        *slot = segment;
                    }
                    *degree += 1;
                }
            }
        }
    }

    /// The segment on the other side of an end, if the chain continues there.
    fn beyond(&self, segment: u32, end: SegmentEnd) -> Option<u32> {
        let SegmentEnd::EdgeFace(crossing) = end else { return None };
        if self.degrees[crossing as usize] != 2 {
            return None;
        }
        let [a, b] = self.links[crossing as usize];
        Some(if a == segment { b } else { a })
    }

    /// Finds an end of the chain of a segment, and follows the chain from there.
    fn trace_from(&mut self, found: &Intersections, seed: u32) {
        let ends = found.segments[seed as usize].ends;
        let (first, start) = match self.terminal(found, seed, ends[0]) {
            None => (seed, ends[0]),
            Some(back) => {
                let ahead = self.terminal(found, seed, ends[1]).unwrap_or((seed, ends[1]));
                // Loop vertices come first; otherwise the end that stands first in the segment's order.
                let is_loop = |(_, end)| matches!(end, SegmentEnd::LoopVertex(_));
                if is_loop(ahead) && !is_loop(back) { ahead } else { back }
            }
        };
        self.follow(found, first, start);
    }

    /// Walks from `seed` out of `end` to where the chain stops; nothing if it returns.
    fn terminal(&self, found: &Intersections, seed: u32, end: SegmentEnd) -> Option<(u32, SegmentEnd)> {
        let (mut segment, mut end) = (seed, end);
        while let Some(next) = self.beyond(segment, end) {
            if next == seed {
                return None;
            }
            end = other_end(found.segments[next as usize].ends, end);
            segment = next;
        }
        Some((segment, end))
    }

    /// Appends the chain that begins with the segment `first` at its end `start`.
    fn follow(&mut self, found: &Intersections, first: u32, start: SegmentEnd) {
        let (first_step, first_node) = (self.steps.len(), self.nodes.len());
        let (mut segment, mut node) = (first, start);
        let mut faces = found.segments[first as usize].faces;
        self.nodes.push(node);
        let returned = loop {
            self.visited[segment as usize] = true;
            self.steps.push(Step { faces });
            node = other_end(found.segments[segment as usize].ends, node);
            self.nodes.push(node);
            let Some(next) = self.beyond(segment, node) else { break None };
            faces = cross(faces, found.segments[segment as usize].faces, found.segments[next as usize].faces);
            if next == first {
                break Some(faces);
            }
            segment = next;
        };
        self.chains.push(Chain {
            steps: first_step..self.steps.len(),
            nodes: first_node..self.nodes.len(),
            closed: returned.is_some(),
            twisted: returned.is_some_and(|faces| faces != self.steps[first_step].faces),
        });
    }
}

fn other_end(ends: [SegmentEnd; 2], end: SegmentEnd) -> SegmentEnd {
    if ends[0] == end { ends[1] } else { ends[0] }
}

/// Follows both copies from one segment to the next: the face that both segments have keeps its copy.
fn cross(faces: [FaceId; 2], segment: [FaceId; 2], next: [FaceId; 2]) -> [FaceId; 2] {
    let stays = |face: FaceId| segment.contains(&face) && next.contains(&face);
    faces.map(|face| {
        if stays(face) {
            face
        } else if stays(next[0]) {
            next[1]
        } else {
            next[0]
        }
    })
}
