//! Ctrl-C: the work ends at the next iteration, and nothing is written.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use signal_hook::{
    SigId,
    consts::{SIGINT, SIGTERM},
    flag, low_level,
};

use super::FixError;

/// Whether the user wants the work to end. The first SIGINT or SIGTERM asks, the second ends the process at once, unless files are
/// being written.
#[derive(Debug, Default)]
pub(super) struct Interrupt {
    asked: Arc<AtomicBool>,
    handlers: Vec<SigId>,
    /// Handlers that end the process.
    hard: Vec<SigId>,
}

impl Interrupt {
    /// Listens from now on.
    pub(super) fn listen() -> io::Result<Self> {
        let mut interrupt = Self::default();
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in this order: the first signal finds the flag unset.
            interrupt.hard.push(flag::register_conditional_shutdown(signal, 2, Arc::clone(&interrupt.asked))?);
            interrupt.handlers.push(flag::register(signal, Arc::clone(&interrupt.asked))?);
        }
        Ok(interrupt)
    }

    /// Whether the work should end.
    pub(super) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// What a signal sets.
    #[cfg(test)]
    pub(super) fn hand(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.asked)
    }

    /// An error if the work should end.
    pub(super) fn check(&self) -> Result<(), FixError> {
        if self.is_asked() { Err(FixError::Interrupted) } else { Ok(()) }
    }

    /// From now on files are being written: a second signal no longer ends the process, so that it can clear away what is half-written.
    pub(super) fn wait_for_files(&mut self) {
        for handler in self.hard.drain(..) {
            low_level::unregister(handler);
        }
    }
}

impl Drop for Interrupt {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..).chain(self.hard.drain(..)) {
            low_level::unregister(handler);
        }
    }
}
