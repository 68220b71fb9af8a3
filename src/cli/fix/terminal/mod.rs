//! The terminal of a repair: the progress line and Ctrl-C.

mod interrupt;
mod progress;

pub(super) use interrupt::Interrupt;
pub(super) use progress::Progress;
