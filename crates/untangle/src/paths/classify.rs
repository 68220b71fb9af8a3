//! From chains to path pairs: types, splits, and the paths in the form that the later stages read.

use arrayvec::ArrayVec;

use super::{
    IntersectionPaths, PairType, PathCopy, PathPair, PathPoint, PathSegment, PathType,
    cross::{Join, Joiner},
    trace::Chains,
    view::{BoundaryEnd, ChainView, Ends},
};
use crate::{
    frame::Frame,
    intersect::Intersections,
    mesh::{Mesh, VertexId},
    stage::{Pace, StageObserver},
};

/// Work of writing out one segment with both copies, in the units of a pace.
const WORK_PER_SEGMENT: usize = 16;

/// Traces and classifies the paths of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct PathFinder {
    chains: Chains,
    joiner: Joiner,
}

impl PathFinder {
    /// Finds the paths of a frame from its intersections.
    ///
    /// Cost: linear in the segments; where k chains meet in one loop vertex, O(k^2) for these and O(k^3) at worst.
    pub fn find(&mut self, mesh: &Mesh, frame: &Frame, found: &Intersections, paths: &mut IntersectionPaths) {
        self.find_within(mesh, frame, found, &mut (), paths);
    }

    /// The same, until the observer says that time is up: then false, and no paths.
    pub(crate) fn find_within(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        found: &Intersections,
        observer: &mut dyn StageObserver,
        paths: &mut IntersectionPaths,
    ) -> bool {
        paths.clear();
        let mut pace = Pace::new(observer);
        if !self.chains.trace(found, &mut pace) {
            return false;
        }
        let view = ChainView { mesh, frame, found, chains: &self.chains };
        self.joiner.join(&view);
        let mut builder = Builder { view, paths };
        for chain in 0..self.chains.chains.len() {
            match self.joiner.of_chain(chain) {
                Join::Alone => builder.add_chain(chain),
                Join::Cross { partner } => builder.add_cross(chain, partner),
                Join::Touching { partner } => builder.add_touching(chain, partner),
                Join::Second => {}
            }
            if pace.is_spent_after(WORK_PER_SEGMENT * self.chains.chains[chain].steps.len()) {
                paths.clear();
                return false;
            }
        }
        true
    }
}

/// One copy of one chain, walked in one direction.
#[derive(Clone, Copy, Debug)]
struct HalfPath {
    chain: usize,
    copy: usize,
    reversed: bool,
}

/// The corresponding path of a copy.
#[derive(Clone, Copy, Debug)]
enum Partner {
    Itself,
    Next,
    Previous,
}

/// Writes pairs and paths out.
struct Builder<'a> {
    view: ChainView<'a>,
    paths: &'a mut IntersectionPaths,
}

impl Builder<'_> {
    /// A chain that is a pair of its own.
    fn add_chain(&mut self, chain: usize) {
        let first_copy = self.paths.copies.len();
        let mut loop_vertices = ArrayVec::new();
        let pair_type = match self.view.ends(chain) {
            Ends::Closed => self.add_closed(chain),
            Ends::LoopLoop(first, last) if first == last => {
                loop_vertices.push(first);
                self.add_eight(chain)
            }
            Ends::LoopLoop(first, last) => {
                loop_vertices.extend([first, last]);
                let halves = [(0, false), (1, true)].map(|(copy, reversed)| HalfPath { chain, copy, reversed });
                self.add_copy(PathType::LoopLoop, Partner::Itself, &halves);
                PairType::LoopLoop
            }
            Ends::LoopBoundary(vertex, end) => {
                loop_vertices.push(vertex);
                self.add_folded(chain, vertex, end)
            }
            Ends::BoundaryBoundary(ends) => self.add_bounded(chain, ends),
        };
        let mut ends = ArrayVec::new();
        if !self.view.chain(chain).closed {
            ends.extend([self.view.end(chain, false), self.view.end(chain, true)]);
        }
        self.paths.pairs.push(PathPair {
            pair_type,
            closed: self.view.chain(chain).closed,
            num_segments: self.view.num_segments(chain),
            length_m: self.view.length_m(chain),
            loop_vertices,
            ends,
            copies: first_copy..self.paths.copies.len(),
        });
    }

    /// A chain without ends: two closed paths, or one of two rounds where the copies exchange their sheets.
    fn add_closed(&mut self, chain: usize) -> PairType {
        let [first, second] = [0, 1].map(|copy| HalfPath { chain, copy, reversed: false });
        if self.view.chain(chain).twisted {
            self.add_copy(PathType::Closed, Partner::Itself, &[first, second]);
        } else {
            self.add_two((PathType::Closed, &[first]), (PathType::Closed, &[second]));
        }
        PairType::Closed
    }

    /// A chain that begins and ends in one loop vertex: two closed paths through it.
    fn add_eight(&mut self, chain: usize) -> PairType {
        let [first, second] = [0, 1].map(|copy| HalfPath { chain, copy, reversed: false });
        self.add_two((PathType::Closed, &[first]), (PathType::Closed, &[second]));
        PairType::Eight
    }

    /// A chain from boundary to boundary: two paths, the one with more ends on boundaries first.
    fn add_bounded(&mut self, chain: usize, ends: [BoundaryEnd; 2]) -> PairType {
        let numbers = [0, 1].map(|copy| ends.iter().filter(|end| end.ends_on_boundary(copy)).count());
        let more = usize::from(numbers[1] > numbers[0]);
        let types = [more, 1 - more].map(|copy| match numbers[copy] {
            0 => PathType::InsideInside,
            1 => PathType::BoundaryInside,
            _ => PathType::BoundaryBoundary,
        });
        let [first, second] = [more, 1 - more].map(|copy| HalfPath { chain, copy, reversed: false });
        self.add_two((types[0], &[first]), (types[1], &[second]));
        match types {
            [PathType::BoundaryBoundary, PathType::BoundaryBoundary] => PairType::BoundaryBoundaryBoundaryBoundary,
            [PathType::BoundaryBoundary, PathType::BoundaryInside] => PairType::BoundaryBoundaryBoundaryInside,
            [PathType::BoundaryBoundary, _] => PairType::BoundaryBoundaryInsideInside,
            _ => PairType::BoundaryInside,
        }
    }

    /// A chain from a loop vertex to the boundary: one path that folds back at the vertex, or two paths where the
    /// vertex is on the boundary.
    fn add_folded(&mut self, chain: usize, vertex: VertexId, end: BoundaryEnd) -> PairType {
        let half = |copy, reversed| HalfPath { chain, copy, reversed };
        let (bounded, free) = (end.bounded, 1 - end.bounded);
        if self.view.mesh.is_boundary_vertex(vertex) {
            let free_type = if end.contact.is_some() { PathType::BoundaryBoundary } else { PathType::BoundaryInside };
            self.add_two((PathType::BoundaryBoundary, &[half(bounded, false)]), (free_type, &[half(free, false)]));
            return match free_type {
                PathType::BoundaryBoundary => PairType::BoundaryBoundaryBoundaryBoundary,
                _ => PairType::BoundaryBoundaryBoundaryInside,
            };
        }
        let (path_type, pair_type) = match end.contact {
            Some(_) => (PathType::BoundaryLoopBoundary, PairType::BoundaryLoopBoundary),
            None => (PathType::BoundaryLoopInside, PairType::BoundaryLoopInside),
        };
        self.add_copy(path_type, Partner::Itself, &[half(bounded, true), half(free, false)]);
        pair_type
    }

    /// Two chains from different loop vertices whose ends on the boundary touch: two BLB paths.
    fn add_touching(&mut self, first: usize, second: usize) {
        let first_copy = self.paths.copies.len();
        let mut loop_vertices = ArrayVec::new();
        for chain in [first, second] {
            if let Ends::LoopBoundary(vertex, end) = self.view.ends(chain) {
                loop_vertices.push(vertex);
                self.add_folded(chain, vertex, end);
            }
        }
        self.paths.pairs.push(PathPair {
            pair_type: PairType::BoundaryLoopLoopBoundary,
            closed: false,
            num_segments: self.view.num_segments(first) + self.view.num_segments(second),
            length_m: self.view.length_m(first) + self.view.length_m(second),
            loop_vertices,
            ends: ArrayVec::from([self.view.end(first, true), self.view.end(second, true)]),
            copies: first_copy..self.paths.copies.len(),
        });
    }

    /// Two chains joined at their loop vertex: a BB path through the vertex and an II path.
    fn add_cross(&mut self, first: usize, second: usize) {
        let first_copy = self.paths.copies.len();
        let (Some((vertex, a)), Some((_, b))) = (self.loop_end(first), self.loop_end(second)) else {
            unreachable!(
                "chains {first} and {second} are joined, but do not both run from a loop vertex to the boundary"
            );
        };
        let through = |a: usize, b: usize| {
            [HalfPath { chain: first, copy: a, reversed: true }, HalfPath { chain: second, copy: b, reversed: false }]
        };
        self.add_two((PathType::BoundaryBoundary, &through(a, b)), (PathType::InsideInside, &through(1 - a, 1 - b)));
        self.paths.pairs.push(PathPair {
            pair_type: PairType::Cross,
            closed: false,
            num_segments: self.view.num_segments(first) + self.view.num_segments(second),
            length_m: self.view.length_m(first) + self.view.length_m(second),
            loop_vertices: ArrayVec::from_iter([vertex]),
            ends: ArrayVec::from([self.view.end(first, true), self.view.end(second, true)]),
            copies: first_copy..self.paths.copies.len(),
        });
    }

    /// The loop vertex of a chain that ends on the boundary, and the copy that ends there.
    fn loop_end(&self, chain: usize) -> Option<(VertexId, usize)> {
        match self.view.ends(chain) {
            Ends::LoopBoundary(vertex, end) => Some((vertex, end.bounded)),
            _ => None,
        }
    }

    /// Two paths that correspond to each other.
    fn add_two(&mut self, first: (PathType, &[HalfPath]), second: (PathType, &[HalfPath])) {
        self.add_copy(first.0, Partner::Next, first.1);
        self.add_copy(second.0, Partner::Previous, second.1);
    }

    /// Writes out one path after splitting, half after half.
    fn add_copy(&mut self, path_type: PathType, partner: Partner, halves: &[HalfPath]) {
        let (first_point, first_segment) = (self.paths.points.len(), self.paths.segments.len());
        for (which, &half) in halves.iter().enumerate() {
            let count = self.view.num_segments(half.chain);
            // Two halves share the point in which they meet.
            for place in usize::from(which > 0)..=count {
                let point = self.point(half, if half.reversed { count - place } else { place });
                self.paths.points.push(point);
            }
            for step in 0..count {
                let step = if half.reversed { count - 1 - step } else { step };
                self.paths.segments.push(PathSegment {
                    own: self.view.face(half.chain, half.copy, step),
                    partner: self.view.face(half.chain, 1 - half.copy, step),
                });
            }
        }
        let index = self.paths.copies.len();
        self.paths.copies.push(PathCopy {
            path_type,
            closed: matches!(path_type, PathType::Closed | PathType::LoopLoop),
            points: first_point..self.paths.points.len(),
            segments: first_segment..self.paths.segments.len(),
            partner: match partner {
                Partner::Itself => index,
                Partner::Next => index + 1,
                Partner::Previous => index - 1,
            },
            pair: self.paths.pairs.len(),
        });
    }

    fn point(&self, HalfPath { chain, copy, .. }: HalfPath, place: usize) -> PathPoint {
        PathPoint {
            position: self.view.position(chain, place),
            own: self.view.surface_point(chain, copy, place),
            partner: self.view.surface_point(chain, 1 - copy, place),
        }
    }
}
