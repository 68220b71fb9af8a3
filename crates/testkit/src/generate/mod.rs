//! Generated meshes with positions. The same seed gives the same bits.

mod bodies;
pub mod degenerate;
mod fan;
pub mod furrows;
pub mod knots;
pub mod mirrored;
pub mod outfits;
mod relabel;
mod sheet;
mod split;
pub mod waves;

pub use fan::fan;
pub use relabel::{Relabelled, relabelled, reordered};
pub use sheet::{Sheet, folded, squares};
pub use split::{Split, split_at_edges};
pub use waves::{crumpled, crumpled_further};
