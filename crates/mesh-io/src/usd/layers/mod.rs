//! Layers of USD: files that say something of prims.
//!
//! | module | purpose |
//! |---|---|
//! | `source`, `archive` | bytes of a layer; layers in `.usdz` |
//! | `value`, `spec` | what layers say, whatever their format |
//! | `binary`, `text` | the formats `.usdc` and `.usda` |
//! | `layer` | a layer of any format |

mod archive;
mod binary;
mod layer;
mod source;
pub(super) mod spec;
mod text;
pub(super) mod value;

pub(super) use layer::{Address, Layer};
