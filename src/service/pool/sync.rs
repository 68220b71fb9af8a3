//! What workers wait by: locks of the system, or with `--cfg model` those of a model (`model_tests.rs`).

#[cfg(all(test, model))]
pub(super) use loom::sync::{Condvar, Mutex, MutexGuard};
#[cfg(not(all(test, model)))]
pub(super) use std::sync::{Condvar, Mutex, MutexGuard};
