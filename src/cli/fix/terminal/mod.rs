//! The terminal of a repair: the progress line and Ctrl-C.

mod interrupt;
mod progress;

pub(in crate::cli) use interrupt::Interrupt;
pub(in crate::cli) use progress::Progress;
