//! Choice of the instruction set at run time.

use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(target_arch = "x86_64")]
use super::avx2::{Avx2F32x8, Avx2F64x4};
use super::{
    lanes::{F32x8Lanes, F64Lanes},
    portable::{ArrayF32x8, Scalar},
};

/// The vectors of one instruction set.
pub(crate) trait InstructionSet: Copy {
    type F32x8: F32x8Lanes;
    type F64: F64Lanes;

    fn f32x8(self) -> Self::F32x8;
    fn f64(self) -> Self::F64;
}

/// Work that is compiled once for each instruction set.
///
/// All functions that it calls in its loops have to be inlined into `run`: one that is not is compiled for the baseline
/// of the target, without the wider vectors. That is why they are marked `inline(always)`, and why closures, which
/// can't be marked, are kept out of the way.
pub(crate) trait Task {
    fn run<S: InstructionSet>(self, simd: S);
}

/// Whether processors are used for what all of them have, and no more.
static IS_PORTABLE: AtomicBool = AtomicBool::new(false);

/// Chooses the instruction set of this process: `portable` for what all processors have, otherwise the best one of this
/// processor. Answers are the same bytes with each; this is for tests of that, and for measuring.
pub fn use_portable_instructions(portable: bool) {
    IS_PORTABLE.store(portable, Ordering::Relaxed);
}

/// Runs a task with the best instruction set of this processor, or the portable one where that was chosen.
pub(crate) fn dispatch(task: impl Task) {
    #[cfg(target_arch = "x86_64")]
    if !IS_PORTABLE.load(Ordering::Relaxed)
        && let Some(simd) = pulp::x86::V3::try_new()
    {
        return simd.vectorize(WithSet(task, simd));
    }
    task.run(Portable);
}

/// What every processor has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl InstructionSet for Portable {
    type F32x8 = ArrayF32x8;
    type F64 = Scalar;

    #[inline(always)]
    fn f32x8(self) -> ArrayF32x8 {
        ArrayF32x8
    }

    #[inline(always)]
    fn f64(self) -> Scalar {
        Scalar
    }
}

#[cfg(target_arch = "x86_64")]
impl InstructionSet for pulp::x86::V3 {
    type F32x8 = Avx2F32x8;
    type F64 = Avx2F64x4;

    #[inline(always)]
    fn f32x8(self) -> Avx2F32x8 {
        Avx2F32x8(self)
    }

    #[inline(always)]
    fn f64(self) -> Avx2F64x4 {
        Avx2F64x4(self)
    }
}

#[cfg(target_arch = "x86_64")]
struct WithSet<T, S>(T, S);

#[cfg(target_arch = "x86_64")]
impl<T: Task, S: InstructionSet> pulp::NullaryFnOnce for WithSet<T, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run(self.1);
    }
}
