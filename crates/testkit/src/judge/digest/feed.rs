//! The numbers of an answer, field by field.

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use untangle::{
    analysis::Analysis,
    intersect::{EdgeFaceIntersection, Intersections, Segment, SegmentEnd},
    labels::VertexLabel,
    mesh::{EdgeId, FaceId, VertexId},
    paths::{
        ChainEnd, IntersectionPaths, PairType, PathCopy, PathPair, PathPoint, PathSegment, PathType, SurfacePoint,
    },
    proximity::{Primitives, ProximityPair},
    regions::{InsideRegion, InsideRegions},
    respond::{Corrections, LeftOut, VertexFlags},
};

use super::hash::{Digest, Feed};

/// Numbers, by their bytes.
macro_rules! feed_bytes {
    ($($number:ty),*) => {
        $(impl Feed for $number {
            fn feed(&self, digest: &mut Digest) {
                digest.bytes(&self.to_le_bytes());
            }
        })*
    };
}

feed_bytes!(u8, u32, usize, f64);

/// Structures, field by field.
macro_rules! feed_fields {
    ($($structure:ident { $($field:ident),* })*) => {
        $(impl Feed for $structure {
            fn feed(&self, digest: &mut Digest) {
                let Self { $($field),* } = self;
                $($field.feed(digest);)*
            }
        })*
    };
}

feed_fields! {
    Analysis { intersections, paths, regions }
    Intersections { edge_face, segments }
    EdgeFaceIntersection { edge, face, edge_parameter, barycentric, position }
    Segment { faces, ends }
    IntersectionPaths { pairs, copies, points, segments }
    PathCopy { path_type, closed, points, segments, partner, pair }
    PathPoint { position, own, partner }
    PathSegment { own, partner }
    InsideRegions { by_copy, vertices, order, num_done }
    InsideRegion { partitioning, vertices, joint, disc_radius }
    ProximityPair { primitives, distance_m }
    VertexLabel { vertex, label }
}

impl Feed for Corrections {
    fn feed(&self, digest: &mut Digest) {
        // Which vertices were touched follows from forces and flags.
        let Self { forces, flags, touched: _, labels, net_force, net_torque, max_displacement_m, left_out } = self;
        forces.feed(digest);
        flags.feed(digest);
        net_force.feed(digest);
        net_torque.feed(digest);
        max_displacement_m.feed(digest);
        left_out.feed(digest);
        // Only where they were asked for: builds without labels have the same digests.
        if !labels.is_empty() {
            labels.feed(digest);
        }
    }
}

impl Feed for LeftOut {
    fn feed(&self, digest: &mut Digest) {
        let Self { num_pairs, length_m, gap } = self;
        num_pairs.feed(digest);
        length_m.feed(digest);
        // Only where a gap is asked for: builds without it have the same digests.
        if *gap {
            digest.bytes(&[1]);
        }
    }
}

/// Values that are fed as another value.
macro_rules! feed_as {
    ($($of:ty: $value:ident => $other:expr;)*) => {
        $(impl Feed for $of {
            fn feed(&self, digest: &mut Digest) {
                let $value = self;
                $other.feed(digest);
            }
        })*
    };
}

feed_as! {
    VertexId: id => id.0;
    FaceId: id => id.0;
    EdgeId: id => id.0;
    VertexFlags: flags => flags.0;
    bool: value => u8::from(*value);
    Range<usize>: range => [range.start, range.end];
    Point3<f64>: point => <[f64; 3]>::from(*point);
    Vector3<f64>: vector => <[f64; 3]>::from(*vector);
}

impl<T: Feed> Feed for [T] {
    fn feed(&self, digest: &mut Digest) {
        self.len().feed(digest);
        self.iter().for_each(|element| element.feed(digest));
    }
}

impl<T: Feed> Feed for Vec<T> {
    fn feed(&self, digest: &mut Digest) {
        self.as_slice().feed(digest);
    }
}

impl<T: Feed, const N: usize> Feed for [T; N] {
    fn feed(&self, digest: &mut Digest) {
        self.iter().for_each(|element| element.feed(digest));
    }
}

impl<T: Feed> Feed for Option<T> {
    fn feed(&self, digest: &mut Digest) {
        self.as_slice().feed(digest);
    }
}

impl Feed for SegmentEnd {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::EdgeFace(index) => [0, *index].feed(digest),
            Self::LoopVertex(vertex) => [1, vertex.0].feed(digest),
        }
    }
}

impl Feed for SurfacePoint {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::Vertex(vertex) => [0, vertex.0].feed(digest),
            Self::Edge { edge, parameter } => {
                [1, edge.0].feed(digest);
                parameter.feed(digest);
            }
            Self::Face { face, barycentric } => {
                [2, face.0].feed(digest);
                barycentric.feed(digest);
            }
        }
    }
}

impl Feed for ChainEnd {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::Boundary { edge: [a, b], face } => [0, *a, *b, *face].feed(digest),
            Self::Loop { vertex } => [1, *vertex].feed(digest),
            Self::Junction { edge: [a, b], face } => [2, *a, *b, *face].feed(digest),
        }
    }
}

impl Feed for PathPair {
    fn feed(&self, digest: &mut Digest) {
        let Self { pair_type, closed, num_segments, length_m, loop_vertices, ends, copies } = self;
        pair_type.feed(digest);
        closed.feed(digest);
        num_segments.feed(digest);
        length_m.feed(digest);
        loop_vertices.as_slice().feed(digest);
        ends.as_slice().feed(digest);
        copies.feed(digest);
    }
}

/// Types of paths, by their names.
macro_rules! feed_names {
    ($($named:ident),*) => {
        $(impl Feed for $named {
            fn feed(&self, digest: &mut Digest) {
                digest.bytes(self.name().as_bytes());
            }
        })*
    };
}

feed_names!(PairType, PathType);

impl Feed for Primitives {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::VertexFace { vertex, face } => [0, vertex.0, face.0].feed(digest),
            Self::EdgeEdge { edges: [a, b] } => [1, a.0, b.0].feed(digest),
        }
    }
}
