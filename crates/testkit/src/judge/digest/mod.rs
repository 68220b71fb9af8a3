//! Digests of all answers, to compare builds, processors and sessions bit for bit.
//!
//! | file | what |
//! |---|---|
//! | `hash` | a digest, and what can be taken into one |
//! | `worlds` | the inputs, which are generated |
//! | `feed` | the numbers of an answer, field by field |
//! | `frames` | which settings, and the frames of each |
//! | `table` | the digests of all inputs as lines of text, by which they are stored |

mod feed;
mod frames;
mod hash;
mod table;
mod worlds;

pub use frames::{FRAMES, Session, choices, digest_frames};
pub use hash::{Digest, Feed};
pub use table::lines;
pub use worlds::{World, worlds};
