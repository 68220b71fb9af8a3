//! All intersections of a frame: which edge pierces which face, and the segments between.
//!
//! The atom is the [`EdgeFaceIntersection`]: a mesh edge that pierces a face it shares no vertex with. Two faces that
//! intersect do so along one [`Segment`], between two of these or between one and a vertex that the faces share, the
//! *loop vertex*.
//!
//! A frame goes through these modules, each of which uses the ones above it only:
//!
//! - `bvh`: broad phase, pairs of faces whose boxes overlap or come within a margin;
//! - `filter`: separating-axis test of pairs and injectivity test of vertex stars, in floating point with error bounds;
//! - `exact`: narrow phase, signs for what the filters leave open;
//! - `search`: the three of them in a row, for one share of a frame, batch by batch;
//! - `limits`: rounds, after each of which the search ends where limits or time are exceeded;
//! - `cache`: certificates that faces are separated, kept from frame to frame until they expire;
//! - `intersector`: the driver, which shares out the work and sorts what is found.

mod assemble;
mod bvh;
mod cache;
mod exact;
mod filter;
mod intersections;
mod intersector;
mod limits;
mod search;
#[cfg(test)]
mod tests;

pub(crate) use bvh::{Bvh, MAX_ADJACENT_FACES, NodePair, WIDTH};
pub use exact::do_intersect;
pub(crate) use filter::{
    OneRings, apart_edges_mask_x8, apart_mask_x8, apart_vertex_face_mask_x8, clear_mask_x8, is_clear,
};
pub use intersections::{EdgeFaceIntersection, Intersections, Segment, SegmentEnd};
pub use intersector::Intersector;
pub use limits::{SearchEnd, SearchLimits};
