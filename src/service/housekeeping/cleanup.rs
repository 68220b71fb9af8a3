//! The cleanup thread: removes resources of crashed peers that iceoryx2 does not remove.
//!
//! It is a thread of its own because iceoryx2 waits without end for a segment that has no length yet; only the removal
//! of that segment ends the wait.

use std::{
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread::JoinHandle,
    time::Duration,
};

use untangled_transport::{Domain, memory};

use super::{changes::ChangeDetector, stale::StaleResources};
use crate::service::error::ServeError;

/// Time between two runs.
const INTERVAL: Duration = Duration::from_secs(1);

/// The thread; it ends when this is dropped.
#[derive(Debug)]
pub(crate) struct Cleanup {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Cleanup {
    /// Removes unfinished segments once, then starts the thread.
    pub(crate) fn start(domain: Domain) -> Result<Self, ServeError> {
        let config = domain.config()?;
        remove_unfinished(&domain);
        let (stop, stopped) = channel();
        let thread = std::thread::Builder::new().name("cleanup".into()).spawn(move || {
            let (mut stale, mut changes) = (StaleResources::default(), ChangeDetector::new(&domain));
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if changes.is_unchanged() && stale.is_empty() {
                    continue;
                }
                remove_unfinished(&domain);
                match stale.sweep(&domain, &config) {
                    Ok(0) => {}
                    Ok(removed) => tracing::info!(removed, "files that killed peers left"),
                    Err(error) => tracing::warn!(%error, "looking for what killed peers left"),
                }
            }
        });
        let thread =
            thread.map_err(|source| ServeError::System { what: "starting the cleanup thread".to_owned(), source })?;
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

fn remove_unfinished(domain: &Domain) {
    match memory::remove_unfinished(domain, memory::UNFINISHED_AGE) {
        Ok(0) => {}
        Ok(removed) => tracing::info!(removed, "segments that killed peers left unfinished"),
        Err(error) => tracing::warn!(%error, "looking for what killed peers left"),
    }
}
