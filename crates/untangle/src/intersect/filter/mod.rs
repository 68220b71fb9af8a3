//! Floating-point filters before the exact signs: only pairs and vertex stars that they leave undecided need signs.
//!
//! - [`separating_axis`]: two triangles have no point in common. In double precision for one pair, for four
//!   ([`separating_axis_x4`]), and in single precision for eight ([`separating_axis_x8`]).
//! - [`vertex_star`]: the faces around a vertex do not intersect beyond it. In double precision, and in single
//!   precision for eight vertices ([`vertex_star_x8`]).
//! - [`apart_x8`]: two triangles, or primitives of them, are farther apart than a margin. In single precision for eight
//!   pairs.
//! - [`clear_star`]: so are the primitives of the faces around a vertex that have none in common.
//! - [`one_rings`]: the neighbours of each vertex in turn, on which the test of vertex stars works.
//!
//! Each bounds its own rounding errors forward, in place, so that a positive answer is certain.

mod apart_x8;
mod clear_star;
mod one_rings;
mod separating_axis;
mod separating_axis_x4;
mod separating_axis_x8;
mod vertex_star;
mod vertex_star_x8;

pub(crate) use apart_x8::{apart_edges_mask_x8, apart_mask_x8, apart_vertex_face_mask_x8};
pub(crate) use clear_star::{clear_mask_x8, is_clear};
pub(crate) use one_rings::OneRings;
pub(crate) use separating_axis::{Triangle, are_separated};
pub(crate) use separating_axis_x4::{ALL_X4, TrianglesX4, max_gaps_m_x4, separated_mask_x4, set_pair};
pub(crate) use separating_axis_x8::separated_mask_x8;
pub(crate) use vertex_star::VertexStarFilter;
pub(crate) use vertex_star_x8::injective_mask_x8;
