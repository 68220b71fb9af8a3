//! What an answer is held against.

pub mod brute_force;
pub mod digest;
pub mod rational;
pub mod rules;
mod summary;

pub use summary::{PairSummary, Summary, summary};
