//! The same input gives the same bytes, with any instructions, threads and sessions, and on every machine.

mod digests;
mod instruction_sets;

use std::sync::{PoisonError, RwLock};

use untangle::simd::use_portable_instructions;

/// The choice of instructions is one of the whole process: who wants those that every processor has is alone with it.
static CHOICE: RwLock<()> = RwLock::new(());

/// What a computation gives with the best instructions of this processor.
fn with_best<T>(compute: impl FnOnce() -> T) -> T {
    let _shared = CHOICE.read().unwrap_or_else(PoisonError::into_inner);
    compute()
}

/// What a computation gives with the instructions that every processor has.
fn with_portable<T>(compute: impl FnOnce() -> T) -> T {
    let _alone = CHOICE.write().unwrap_or_else(PoisonError::into_inner);
    use_portable_instructions(true);
    let result = compute();
    use_portable_instructions(false);
    result
}
