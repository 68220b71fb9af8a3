//! Removes what peers left in shared memory that were killed while they made it.
//!
//! On a thread of its own: iceoryx2 waits without end for a segment that has no length yet, and only its removal ends that.

use std::{
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread::JoinHandle,
    time::Duration,
};

use untangled_transport::{Domain, memory};

use super::{error::ServeError, leftovers::Leftovers, quiet::Quiet};

/// How often it looks.
const INTERVAL: Duration = Duration::from_secs(1);

/// The thread; it ends with this.
#[derive(Debug)]
pub(super) struct Janitor {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Janitor {
    /// Looks once, then starts the thread.
    pub(super) fn start(domain: Domain) -> Result<Self, ServeError> {
        let config = domain.config()?;
        remove_unfinished(&domain);
        let (stop, stopped) = channel();
        let thread = std::thread::Builder::new().name("janitor".into()).spawn(move || {
            let (mut leftovers, mut quiet) = (Leftovers::default(), Quiet::new(&domain));
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                if quiet.is_quiet() && leftovers.is_empty() {
                    continue;
                }
                remove_unfinished(&domain);
                match leftovers.sweep(&domain, &config) {
                    Ok(0) => {}
                    Ok(removed) => tracing::info!(removed, "files that killed peers left"),
                    Err(error) => tracing::warn!(%error, "looking for what killed peers left"),
                }
            }
        });
        let thread = thread.map_err(|source| ServeError::System { what: "starting the janitor", source })?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Janitor {
    fn drop(&mut self) {
        self.stop.take();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so already.
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
