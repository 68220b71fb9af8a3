//! What workers wait by. The model of the queue has its own of these names (`model_tests.rs`).

pub(super) use std::sync::{Condvar, Mutex, MutexGuard};
