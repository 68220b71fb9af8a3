//! Files that tests read or write.

pub mod formats;
pub mod npz;
mod shared;

pub use shared::{repository, shared};
