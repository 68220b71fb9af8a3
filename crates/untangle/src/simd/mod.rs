//! SIMD arithmetic: operations on vectors of lanes, written once and compiled for each instruction set.
//!
//! An algorithm is generic over `Lanes` (what one lane can do) or over an `InstructionSet` (which vectors there
//! are), and `dispatch` runs it with the best set of the processor. All sets do the same IEEE operations in the same
//! order, none of them fused, so that they give the same bits.
//!
//! The whole library keeps to this: no kernel of another crate that chooses instructions by the processor takes part in
//! an answer, and logarithms and arcs come from `libm`, not from the system. So the same input gives the same bytes on
//! every processor of an architecture.
//!
//! The traits are our own, not `pulp::Simd`, although `pulp` has the instructions: its trait has no way from a mask to
//! bits and no gather that transposes, and its scalar minimum is `f64::min`, several instructions for the sake of NaN.
//! With all three written for each set anyway, only one-line forwards would be left to share.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod dispatch;
mod lanes;
mod portable;
#[cfg(test)]
mod tests;

pub use dispatch::use_portable_instructions;
pub(crate) use dispatch::{InstructionSet, Portable, Task, dispatch};
pub(crate) use lanes::{F32_LANES, F32x8Lanes, F64_LANES, F64Lanes, Lanes};
pub(crate) use portable::Scalar;
