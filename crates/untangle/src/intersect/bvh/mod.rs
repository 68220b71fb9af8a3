//! Broad phase: a bounding volume hierarchy (BVH) of axis-aligned bounding boxes, refitted each frame (Ericson 2004,
//! chapter 6).
//!
//! The tree is implicit and eight wide: faces stand in one array, sorted once so that neighbours in space are
//! neighbours in the array, and node `g` of a level covers nodes `8 g .. 8 g + 8` of the level below. All leaves have
//! the same depth, so that a traversal pairs nodes of one level only.
//!
//! Boxes are in single precision. One map for the whole frame takes coordinates there:
//! `x -> f32((x - centre) * scale)`. Each of its steps is monotone in floating-point arithmetic, so intervals that
//! overlap before the map overlap after it: no pair is lost, wherever the cloth is and however large, and nothing needs
//! to be rounded outwards. Where a few vertices are far from all others, the map resolves the others, and what else is
//! done in single precision passes over the few.
//!
//! Pairs of faces that share a vertex always overlap. They are known from the topology, left out here, and tested
//! around each vertex instead. All boxes round a vertex of many faces overlap there: these faces stand side by side in
//! the array, and pairs of nodes all of whose faces share that vertex are passed over together.

mod aabb;
mod adjacency;
mod build;
mod hubs;
mod refit;
mod single_map;
mod traverse;
mod tree;
mod within_margin;

pub(crate) use aabb::WIDTH;
pub(super) use aabb::min;
pub(crate) use adjacency::MAX_ADJACENT_FACES;
pub(crate) use refit::POINT_F32_ERROR;
pub(crate) use single_map::PointF32;
pub(crate) use tree::{Bvh, NodePair};
