//! The sessions that pages look at, each with one observer.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError, atomic::AtomicU64},
};

use super::{
    channel::Channel,
    source::{SessionLine, Source},
};

/// All of them.
pub(super) struct Hub {
    source: Arc<dyn Source>,
    channels: Mutex<HashMap<String, Arc<Channel>>>,
    /// Frames are counted over all of them, so that a session that is observed again goes on counting.
    num_fetched: Arc<AtomicU64>,
}

impl Hub {
    pub(super) fn new(source: Arc<dyn Source>) -> Self {
        Self { source, channels: Mutex::default(), num_fetched: Arc::default() }
    }

    /// Which daemon this is, in words.
    pub(super) fn name(&self) -> &str {
        self.source.name()
    }

    /// See [`Source::sessions`].
    pub(super) fn sessions(&self) -> Result<Vec<SessionLine>, String> {
        self.source.sessions()
    }

    /// The observer of a session, a new one where there is none.
    pub(super) fn channel(&self, session: &str) -> Result<Arc<Channel>, String> {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        channels.retain(|_, channel| !channel.has_ended());
        if let Some(channel) = channels.get(session) {
            return Ok(Arc::clone(channel));
        }
        let channel = Arc::new(Channel::open(&self.source, session, &self.num_fetched)?);
        channels.insert(session.to_owned(), Arc::clone(&channel));
        Ok(channel)
    }

    /// Ends all observers, and waits until they have left the daemon.
    pub(super) fn close(&self) {
        for (_, channel) in self.channels.lock().unwrap_or_else(PoisonError::into_inner).drain() {
            channel.close();
        }
    }
}
