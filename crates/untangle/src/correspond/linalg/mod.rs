//! Linear algebra in memory that is kept from one system to the next, so that a frame allocates nothing after the first
//! ones.

mod cholesky;
mod saddle_point;
mod scratch;
mod sparse;

pub(super) use cholesky::Cholesky;
pub(super) use saddle_point::SaddlePoint;
pub(super) use sparse::SparseSymmetric;
