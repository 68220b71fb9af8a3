//! The cleanup thread: removes resources of crashed peers that iceoryx2 does not remove.
//!
//! It is a thread of its own because iceoryx2 waits without end for a segment that has no length yet; only the removal
//! of that segment ends the wait.

use std::{
    io,
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread::JoinHandle,
    time::Duration,
};

use iceoryx2::prelude::Config;

use super::{changes::ChangeDetector, stale::StaleResources};
use crate::{Domain, memory};

/// Time between two runs.
const INTERVAL: Duration = Duration::from_secs(1);

/// What the thread has done, for a log.
#[derive(Debug)]
pub enum Finding {
    /// So many segments were removed that killed peers left unfinished.
    Unfinished(usize),
    /// So many files were removed that killed peers left.
    Left(usize),
    /// The search failed.
    Failed(io::Error),
}

/// The thread; it ends when this is dropped.
#[derive(Debug)]
pub struct Cleanup {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Cleanup {
    /// Removes unfinished segments once, then starts the thread. `config` is that of the domain; `report` gets what was
    /// found, and nothing where there was nothing.
    ///
    /// # Errors
    /// What the system says where it starts no thread.
    pub fn start(domain: Domain, config: Config, report: impl Fn(Finding) + Send + 'static) -> io::Result<Self> {
        remove_unfinished(&domain, &report);
        let (stop, stopped) = channel();
        let thread = std::thread::Builder::new().name("cleanup".into()).spawn(move || {
            let (mut stale, mut changes) = (StaleResources::default(), ChangeDetector::new(&domain));
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if changes.is_unchanged() && stale.is_empty() {
                    continue;
                }
                remove_unfinished(&domain, &report);
                match stale.sweep(&domain, &config) {
                    Ok(0) => {}
                    Ok(removed) => report(Finding::Left(removed)),
                    Err(error) => report(Finding::Failed(error)),
                }
            }
        })?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Cleanup {
    fn drop(&mut self) {
        self.stop.take();
        if let Some(thread) = self.thread.take() {
            // The panic hook has reported a thread that panicked.
            let _ = thread.join();
        }
    }
}

fn remove_unfinished(domain: &Domain, report: &impl Fn(Finding)) {
    match memory::remove_unfinished(domain, memory::UNFINISHED_AGE) {
        Ok(0) => {}
        Ok(removed) => report(Finding::Unfinished(removed)),
        Err(error) => report(Finding::Failed(error)),
    }
}
