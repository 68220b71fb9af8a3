//! Linear algebra in memory that is kept from one system to the next, so that a frame allocates nothing after the first
//! ones.

mod band;
mod cholesky;
mod ordering;
mod pivoted;
mod reflections;
mod rows;
mod saddle_point;
mod sparse;
mod triangular;

pub(super) use band::{Band, BandMatrix};
pub(crate) use cholesky::Cholesky;
pub(super) use rows::Row;
pub(super) use saddle_point::SaddlePoint;
pub(crate) use sparse::SparseSymmetric;
