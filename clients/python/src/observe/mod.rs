//! Watching sessions of other processes.

mod observation;
mod observer;

pub(crate) use observation::NativeObservation;
pub(crate) use observer::{NativeObserver, sessions};
