//! Ctrl-C: the work ends soon, and nothing is written.

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

use crate::cli::fix::error::FixError;

/// Listens for SIGINT and SIGTERM. The first signal asks the work to end; the second ends the process at once, unless
/// files are being written.
#[derive(Debug, Default)]
pub(crate) struct Interrupt {
    asked: Arc<AtomicBool>,
    handlers: Vec<SigId>,
    /// Handlers that end the process at once.
    hard_handlers: Vec<SigId>,
}

impl Interrupt {
    /// Starts listening.
    pub(crate) fn listen() -> io::Result<Self> {
        let mut interrupt = Self::default();
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in the order of registration, so that the first signal finds the flag unset.
            interrupt.hard_handlers.push(flag::register_conditional_shutdown(signal, 2, Arc::clone(&interrupt.asked))?);
            interrupt.handlers.push(flag::register(signal, Arc::clone(&interrupt.asked))?);
        }
        Ok(interrupt)
    }

    /// Whether the work should end.
    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The flag that a signal sets, for other threads.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.asked)
    }

    /// An error if the work should end.
    pub(crate) fn check(&self) -> Result<(), FixError> {
        if self.is_asked() { Err(FixError::Interrupted) } else { Ok(()) }
    }

    /// Says that files are being written from now on: a second signal no longer ends the process, so that it can remove
    /// unfinished files.
    pub(crate) fn wait_for_files(&mut self) {
        for handler in self.hard_handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}

impl Drop for Interrupt {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..).chain(self.hard_handlers.drain(..)) {
            low_level::unregister(handler);
        }
    }
}
