//! Removes what peers left in shared memory that were killed while they made it.
//!
//! On a thread of its own: iceoryx2 waits without end for a segment that has no length yet, and only its removal ends that.

use std::{
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread::JoinHandle,
    time::Duration,
};

use untangled_proto::{Domain, memory};

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
    pub(super) fn start(domain: Domain) -> std::io::Result<Self> {
        sweep(&domain);
        let (stop, stopped) = channel();
        let thread = std::thread::Builder::new().name("janitor".into()).spawn(move || {
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                sweep(&domain);
            }
        })?;
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

fn sweep(domain: &Domain) {
    match memory::remove_unfinished(domain, memory::UNFINISHED_AGE) {
        Ok(0) => {}
        Ok(removed) => tracing::info!(removed, "segments that killed peers left unfinished"),
        Err(error) => tracing::warn!(%error, "looking for what killed peers left"),
    }
}
