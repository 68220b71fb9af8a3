//! Coherence in time: corrections of single frames of a shot become corrections that grow in, change and fade out
//! smoothly.
//!
//! Frames are repaired one by one, and each repair knows nothing of its neighbours. A correction is carried to another
//! frame with the material: as a vector in directions that turn with the cloth round its vertex ([`Turns`]). There the
//! corrections of all frames within a window are averaged, and weighted so that they fade to nothing at its end
//! ([`spread`]). What comes out may intersect; the caller checks it, repairs it from there, and spreads what that added
//! in the same way.
//!
//! | file | purpose |
//! |---|---|
//! | `fade` | the weights |
//! | `turns` | how the cloth turned round its vertices |
//! | `spread` | corrections of a window of frames, averaged and faded |
//! | `roughness` | how smooth corrections are, beside a smooth bump |
//!
//! A row uses those above it only.

mod fade;
mod roughness;
mod spread;
#[cfg(test)]
mod tests;
mod turns;

use std::collections::BTreeMap;

pub use fade::Fade;
pub use roughness::{Roughness, RoughnessMeter};
pub use spread::spread;
pub use turns::Turns;

/// Vectors of some vertices, in metres; all others have none.
pub type SparseField = BTreeMap<u32, nalgebra::Vector3<f64>>;
