//! Targets on meshes where the true ones are known, and the meshes.

mod folds;
pub(crate) mod samples;
mod tubes;
