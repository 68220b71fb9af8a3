//! Clearance: primitives that are nearer to each other than a gap are set apart, for solvers that refuse states that
//! are too close.
//!
//! Iterations from a state without intersections: all pairs below the gap give separation constraints along the line of
//! their closest points; the least change of shape that satisfies them is found as for the untangling; the step along
//! it intersects nothing, as the line search of incremental potential contact does (Li et al. 2020), but without a
//! barrier: distances need not stay above zero by an energy where every step is checked exactly.
//!
//! Not every pair can be set apart: primitives that are connected along the surface by less than the gap, that are held
//! from both sides, or pinned, or part of a tangle that is left. These get no constraints once they are recognised, so
//! that nothing is stretched in vain, and are named.
//!
//! | file | purpose |
//! |---|---|
//! | `outcome` | what a caller gets |
//! | `required` | how far apart a pair has to be, the rounding of files included |
//! | `tangled` | what is left tangled, and stays as it is |
//! | `obstacles` | pairs that can't be set apart |
//! | `rows` | constraints of the others |
//! | `step` | a step that intersects nothing and overstretches nothing |
//! | `solve` | the iterations |
//!
//! A row uses those above it only.

mod obstacles;
mod outcome;
mod required;
mod rows;
mod solve;
mod step;
mod tangled;
#[cfg(test)]
mod tests;

pub use outcome::{Clearance, ClearanceObstacle, InfeasiblePlace};
pub use solve::open_gap;
