//! Intersection paths: segments joined, followed over both sheets, and classified by where they end.
//!
//! Glossary. An intersection path is what the literature also calls a contour (Baraff, Witkin and Kass 2003; Volino and
//! Magnenat-Thalmann 2006). A *chain* is a connected run of segments in the world. Each point of it touches the cloth
//! in two places, so it has two *copies*; each copy is the other's *corresponding path*. Where the two faces of a
//! segment share a vertex, the *loop vertex*, both copies meet and a path folds back: path and corresponding path are
//! then one. A [`PathPair`] is a pair as it is traced, a [`PathCopy`] one path after EIGHT, CROSS and BLLB are split.

mod chords;
mod classify;
mod contact;
mod cross;
mod fan;
mod sheet;
mod trace;
mod view;

use std::ops::Range;

use arrayvec::ArrayVec;
use nalgebra::Point3;
use serde::Serialize;

use crate::mesh::{EdgeId, FaceId, VertexId};

pub use classify::PathFinder;
pub(crate) use sheet::Sheet;

/// Type of a pair of corresponding paths, before splitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(into = "&'static str")]
pub enum PairType {
    /// Two closed paths.
    Closed,
    /// One closed path with one loop vertex, visited twice: two closed paths after the split.
    Eight,
    /// A closed path with two loop vertices: a line in the world.
    LoopLoop,
    /// From the boundary to a loop vertex and back to the inside.
    BoundaryLoopInside,
    /// From the boundary to a loop vertex and back to the boundary.
    BoundaryLoopBoundary,
    /// Two BLI whose free ends touch on the boundary.
    BoundaryLoopLoopBoundary,
    /// Two BLI that share their loop vertex: a BB/II pair after the split.
    Cross,
    /// One copy ends twice on the boundary, the other never.
    BoundaryBoundaryInsideInside,
    /// One copy ends twice on the boundary, the other once.
    BoundaryBoundaryBoundaryInside,
    /// Both copies end twice on the boundary.
    BoundaryBoundaryBoundaryBoundary,
    /// Both copies end once on the boundary.
    BoundaryInside,
}

impl PairType {
    /// The name of the type in the paper, used in reports, files and pictures.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closed => "CLOSED/CLOSED",
            Self::Eight => "EIGHT",
            Self::LoopLoop => "LL",
            Self::BoundaryLoopInside => "BLI",
            Self::BoundaryLoopBoundary => "BLB",
            Self::BoundaryLoopLoopBoundary => "BLLB",
            Self::Cross => "CROSS",
            Self::BoundaryBoundaryInsideInside => "BB/II",
            Self::BoundaryBoundaryBoundaryInside => "BB/BI",
            Self::BoundaryBoundaryBoundaryBoundary => "BB/BB",
            Self::BoundaryInside => "BI/BI",
        }
    }
}

impl From<PairType> for &'static str {
    fn from(value: PairType) -> Self {
        value.name()
    }
}

/// Type of one path after splitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(into = "&'static str")]
pub enum PathType {
    /// A loop without a loop vertex.
    Closed,
    /// A loop with two loop vertices, its own corresponding path.
    LoopLoop,
    /// Boundary, loop vertex, inside; its own corresponding path.
    BoundaryLoopInside,
    /// Boundary, loop vertex, boundary; its own corresponding path.
    BoundaryLoopBoundary,
    /// Both ends on the boundary.
    BoundaryBoundary,
    /// One end on the boundary.
    BoundaryInside,
    /// No end on the boundary.
    InsideInside,
}

impl PathType {
    /// The name of the type in the paper, used in reports, files and pictures.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closed => "CLOSED",
            Self::LoopLoop => "LL",
            Self::BoundaryLoopInside => "BLI",
            Self::BoundaryLoopBoundary => "BLB",
            Self::BoundaryBoundary => "BB",
            Self::BoundaryInside => "BI",
            Self::InsideInside => "II",
        }
    }
}

impl From<PathType> for &'static str {
    fn from(value: PathType) -> Self {
        value.name()
    }
}

/// A place on the cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfacePoint {
    /// In a vertex (loop vertices only).
    Vertex(VertexId),
    /// On an edge, 0 at its first vertex, 1 at its second.
    Edge {
        /// The edge.
        edge: EdgeId,
        /// Position along it.
        parameter: f64,
    },
    /// Inside a face.
    Face {
        /// The face.
        face: FaceId,
        /// One coordinate for each corner; they sum to 1.
        barycentric: [f64; 3],
    },
}

/// One point of a path: its world position, and where it touches the cloth on this path and on the corresponding one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// World position in metres.
    pub position: Point3<f64>,
    /// Place on the cloth along this path.
    pub own: SurfacePoint,
    /// Place on the cloth along the corresponding path.
    pub partner: SurfacePoint,
}

/// The run of a path through one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSegment {
    /// The face that this path runs through.
    pub own: FaceId,
    /// The face that the corresponding path runs through.
    pub partner: FaceId,
}

/// One path after splitting.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCopy {
    /// Its type.
    pub path_type: PathType,
    /// Whether it is a loop on the cloth.
    pub closed: bool,
    /// Its points in [`IntersectionPaths::points`]: one more than segments; a closed path repeats its first point at
    /// the end.
    pub points: Range<usize>,
    /// Its segments in [`IntersectionPaths::segments`].
    pub segments: Range<usize>,
    /// Index of the corresponding path in [`IntersectionPaths::copies`]; its own index for LL, BLI, BLB, and for a
    /// closed path that returns on the other sheet (non-orientable cloth).
    pub partner: usize,
    /// Index of the pair in [`IntersectionPaths::pairs`].
    pub pair: usize,
}

/// Where a chain ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum ChainEnd {
    /// A boundary edge pierces a face.
    Boundary {
        /// Vertices of the edge.
        edge: [u32; 2],
        /// The face.
        face: u32,
    },
    /// The two sheets meet in a vertex.
    Loop {
        /// The vertex.
        vertex: u32,
    },
    /// An edge of more than two faces pierces a face, or the other way round: the chain was split here.
    Junction {
        /// Vertices of the edge.
        edge: [u32; 2],
        /// The face.
        face: u32,
    },
}

/// A pair of corresponding paths, before splitting.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPair {
    /// Its type.
    pub pair_type: PairType,
    /// Whether it is a loop in the world.
    pub closed: bool,
    /// Number of intersecting face pairs along it.
    pub num_segments: usize,
    /// World length in metres.
    pub length_m: f64,
    /// Loop vertices, in the order met.
    pub loop_vertices: ArrayVec<VertexId, 2>,
    /// Ends of its chain in the world, in the order met, or the free ends of its two chains (CROSS, BLLB); none for a
    /// closed one.
    pub ends: ArrayVec<ChainEnd, 2>,
    /// Its paths after splitting, in [`IntersectionPaths::copies`].
    pub copies: Range<usize>,
}

/// All paths of a frame.
#[derive(Clone, Debug, Default)]
pub struct IntersectionPaths {
    /// Pairs, in the order of their lowest segment.
    pub pairs: Vec<PathPair>,
    /// Paths after splitting, pair by pair.
    pub copies: Vec<PathCopy>,
    /// Points of all copies.
    pub points: Vec<PathPoint>,
    /// Segments of all copies.
    pub segments: Vec<PathSegment>,
}

impl IntersectionPaths {
    /// Forgets all of them.
    fn clear(&mut self) {
        self.pairs.clear();
        self.copies.clear();
        self.points.clear();
        self.segments.clear();
    }

    /// World length from the start of a path to each of its points, in metres. Corresponding paths share their world
    /// positions, so that it is the arclength of both; on a path that folds back at a loop vertex both directions
    /// count.
    pub fn arclengths_m(&self, copy: &PathCopy) -> impl Iterator<Item = f64> + '_ {
        let points = &self.points[copy.points.clone()];
        let mut length = 0.0;
        points.iter().enumerate().map(move |(index, point)| {
            if index > 0 {
                length += (point.position - points[index - 1].position).norm();
            }
            length
        })
    }
}
