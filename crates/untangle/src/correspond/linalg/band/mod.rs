//! Cholesky factorisation of matrices with the pattern of a narrow mesh: in the order of a breadth-first walk all
//! entries lie in a narrow band, and go without indices.
//!
//! Entries are real or complex. The unknowns are complex: places in the plane.

mod matrix;
mod shape;
#[cfg(test)]
mod tests;

pub(crate) use matrix::BandMatrix;
pub(crate) use shape::Band;
