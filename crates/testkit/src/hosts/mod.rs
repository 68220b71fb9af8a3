//! Programs in other languages: what is on this machine, and the libraries that they need.

mod frames;
pub mod python;
mod tools;

pub use frames::Frames;
pub use tools::{has, libraries, link, run, scratch};
