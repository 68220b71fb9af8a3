//! Ctrl-C: the process ends at once, and nothing is written.

use std::{
    fs,
    io::{self, IsTerminal, Read},
    os::unix::net::UnixStream,
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use signal_hook::{
    SigId,
    consts::{SIGINT, SIGTERM},
    low_level,
};
use tempfile::NamedTempFile;

use crate::cli::fix::error::FixError;

/// Listens for SIGINT and SIGTERM. A signal removes the files that are not in their places yet and ends the process,
/// whatever it is doing, unless these files are being put in their places: that takes a moment, and half of them would
/// be worse than all.
#[derive(Debug, Default)]
pub(crate) struct Interrupt {
    shared: Arc<Shared>,
    handlers: Vec<SigId>,
}

#[derive(Debug, Default)]
struct Shared {
    /// What is said at the end, if it is not that nothing was written.
    words: Option<&'static str>,
    asked: AtomicBool,
    files: Mutex<Files>,
}

#[derive(Debug, Default)]
struct Files {
    /// Files beside their places, removed ones among them.
    staged: Vec<PathBuf>,
    committed: bool,
}

impl Interrupt {
    /// Starts listening.
    pub(crate) fn listen() -> io::Result<Self> {
        Self::default().start()
    }

    /// Starts listening, for work that keeps what is finished. `words` say so.
    pub(crate) fn listen_saying(words: &'static str) -> io::Result<Self> {
        let shared = Arc::new(Shared { words: Some(words), ..Shared::default() });
        Self { shared, handlers: Vec::new() }.start()
    }

    fn start(mut self) -> io::Result<Self> {
        let interrupt = &mut self;
        let (mut receiver, sender) = UnixStream::pair()?;
        for signal in [SIGINT, SIGTERM] {
            interrupt.handlers.push(low_level::pipe::register(signal, sender.try_clone()?)?);
        }
        let shared = Arc::clone(&interrupt.shared);
        // It ends with the handlers, which hold the other ends of the pair.
        thread::Builder::new().name("signals".into()).spawn(move || {
            drop(sender);
            while receiver.read_exact(&mut [0]).is_ok() {
                shared.end_process();
            }
        })?;
        Ok(self)
    }

    /// The flag that asks the work to end, for solvers.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.shared.asked
    }

    /// An error if the work should end.
    pub(crate) fn check(&self) -> Result<(), FixError> {
        if self.shared.asked.load(Ordering::Relaxed) { Err(FixError::Interrupted) } else { Ok(()) }
    }

    /// Makes a temporary file that a signal removes.
    pub(crate) fn stage(&self, create: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
        let mut files = self.shared.lock();
        let file = create()?;
        files.staged.push(file.path().to_path_buf());
        Ok(file)
    }

    /// Says that the files are put in their places from now on, and that a signal no longer ends the process; an error
    /// if the work should end.
    pub(crate) fn commit(&self) -> Result<(), FixError> {
        let mut files = self.shared.lock();
        self.check()?;
        files.committed = true;
        Ok(())
    }
}

impl Drop for Interrupt {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Files> {
        // Nothing panics while it holds the lock and leaves the list wrong.
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end_process(&self) {
        let files = self.lock();
        if files.committed {
            return;
        }
        self.asked.store(true, Ordering::Relaxed);
        for path in &files.staged {
            // It may be gone already.
            let _ = fs::remove_file(path);
        }
        // A line of progress may stand on the terminal.
        let fresh = if io::stderr().is_terminal() { "\r\x1b[K" } else { "" };
        match self.words {
            Some(words) => eprintln!("{fresh}untangled: {words}"),
            None => eprintln!("{fresh}untangled: {}", FixError::Interrupted),
        }
        // Without destructors: other threads are at work on what they would destroy.
        low_level::exit(2);
    }
}
