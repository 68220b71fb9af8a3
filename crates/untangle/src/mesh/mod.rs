//! Immutable connectivity of a cloth: validated once, unchanged from then on.
//!
//! A mesh holds no positions of a frame, so no rounding can corrupt connectivity; positions of one instant are a
//! [`Frame`](crate::frame::Frame). Words: a *piece* is a connected component of faces joined by edges; a *boundary*
//! edge has one face; an edge of more than two faces is *non-manifold*; a face with a repeated index is *ignored* by
//! everything but the counts of the input.

mod build;
mod connectivity;
mod csr;
mod description;
mod error;
mod identity;
mod ids;
mod uv_chart;
mod validate;

pub use connectivity::Mesh;
pub use description::{MeshDescription, Uvs};
pub use error::MeshError;
pub use ids::{EdgeId, FaceId, PieceId, VertexId};

pub(crate) use connectivity::VERTICES_PER_BLOCK;
pub(crate) use csr::Csr;
pub(crate) use identity::MeshIdentity;
pub(crate) use ids::MeshId;
pub(crate) use validate::is_usable;
