//! The open sessions of a host end.

use std::{
    collections::HashMap,
    sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard},
};

use super::session::Session;

/// The open sessions, by link: the callback of the network looks here for each message.
#[derive(Debug, Default)]
pub(crate) struct Sessions(RwLock<HashMap<u64, Arc<Session>>>);

impl Sessions {
    fn read(&self) -> RwLockReadGuard<'_, HashMap<u64, Arc<Session>>> {
        // A panic while it is held leaves no inconsistent state.
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, HashMap<u64, Arc<Session>>> {
        self.0.write().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn insert(&self, session: Arc<Session>) {
        self.write().insert(session.link, session);
    }

    pub(crate) fn by_link(&self, link: u64) -> Option<Arc<Session>> {
        self.read().get(&link).cloned()
    }

    pub(crate) fn by_id(&self, id: u64) -> Option<Arc<Session>> {
        self.read().values().find(|session| session.id == id).cloned()
    }

    /// Removes sessions, and gives them back.
    pub(crate) fn remove_where(&self, mut is_removed: impl FnMut(&Session) -> bool) -> Vec<Arc<Session>> {
        if !self.read().values().any(|session| is_removed(session)) {
            return Vec::new();
        }
        self.write().extract_if(|_, session| is_removed(session)).map(|(_, session)| session).collect()
    }

    pub(crate) fn for_each(&self, visit: impl FnMut(&Arc<Session>)) {
        self.read().values().for_each(visit);
    }

    pub(crate) fn len(&self) -> usize {
        self.read().len()
    }

    /// Links to a daemon end.
    pub(crate) fn links_to(&self, daemon: &str) -> Vec<u64> {
        let sessions = self.read();
        sessions.values().filter(|session| &*session.remote.daemon == daemon).map(|session| session.link).collect()
    }
}
