//! Types of paths, and how chains of segments become paths.

mod crossings;
mod expect;
mod folds;
mod tracing;
