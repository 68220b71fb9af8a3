//! A second judge of intersections and gaps, in rational numbers.
//!
//! Written from "The perturbed input, to the letter" in `docs/manual/exactness.md` alone, whose rules are named by
//! their numbers here. It shares no code with the library, neither its signs nor its distances, nor the crates below
//! them, and it is slow: milliseconds for a mesh of ten faces.
//!
//! | file | what |
//! |---|---|
//! | `number` | coordinates as fractions (rule 1) |
//! | `moved` | the sign of four moved points, a polynomial in the size of the move (rules 2, 3) |
//! | `surface` | faces, edges, and which of them intersect (rules 4 to 7) |
//! | `gap` | squared distances of points and triangles, and of segments |
//! | `library` | the library's answers held against these |
//! | `checker` | the answers of the judge of files held against these |
//! | `random` | both, for a random mesh |

mod checker;
mod gap;
mod library;
mod moved;
mod number;
mod random;
mod surface;

pub use library::Compared;
pub use random::{Comparison, compare_random};
