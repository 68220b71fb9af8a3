//! Handles that a caller holds: numbers that are looked up, so that a stale one is an error and never an address.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock},
    time::Duration,
};

use client::{Client, ContactFilter, Correction, Loan, Repair, Session};

use crate::error::{ErrorCode, Fault};

/// Corrections that a session may hold at a time: what the transport lends, less the one that is being received.
pub(crate) const MAX_HELD: usize = 3;

/// All open clients of this process.
pub(crate) static CLIENTS: Table<Client> = Table::new("client");
/// All open sessions of this process.
pub(crate) static SESSIONS: Table<OpenSession> = Table::new("session");

/// All filters of contacts of this process.
pub(crate) static CONTACTS: Table<ContactFilter> = Table::new("filter of contacts");

/// Objects by number. A number is never used again.
pub(crate) struct Table<T> {
    entries: RwLock<Entries<T>>,
    what: &'static str,
}

struct Entries<T> {
    last: u64,
    // Few, so that a search costs less than a hash.
    list: Vec<(u64, Arc<Mutex<T>>)>,
}

impl<T> Table<T> {
    const fn new(what: &'static str) -> Self {
        Self { entries: RwLock::new(Entries { last: 0, list: Vec::new() }), what }
    }

    pub(crate) fn add(&self, object: T) -> u64 {
        let mut entries = self.entries.write().unwrap_or_else(PoisonError::into_inner);
        entries.last += 1;
        let id = entries.last;
        entries.list.push((id, Arc::new(Mutex::new(object))));
        id
    }

    pub(crate) fn get(&self, id: u64) -> Result<Arc<Mutex<T>>, Fault> {
        let entries = self.entries.read().unwrap_or_else(PoisonError::into_inner);
        let found = entries.list.iter().find(|entry| entry.0 == id).map(|entry| Arc::clone(&entry.1));
        found.ok_or_else(|| self.stale(id))
    }

    /// Takes an object out; another thread that is using it finishes first.
    pub(crate) fn remove(&self, id: u64) -> Result<Arc<Mutex<T>>, Fault> {
        let mut entries = self.entries.write().unwrap_or_else(PoisonError::into_inner);
        let place = entries.list.iter().position(|entry| entry.0 == id).ok_or_else(|| self.stale(id))?;
        Ok(entries.list.swap_remove(place).1)
    }

    fn stale(&self, id: u64) -> Fault {
        Fault::new(
            ErrorCode::InvalidHandle,
            format_args!("{id} is no open {0}: it was closed, or no {0} ever had this number", self.what),
        )
    }
}

/// Locks an object for one call. A panic in an earlier call leaves no inconsistent state that matters, so a poisoned
/// lock is used on.
pub(crate) fn lock<T>(object: &Mutex<T>) -> MutexGuard<'_, T> {
    object.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A session with the loan, the corrections and the repair that the caller holds. Fields are dropped in order:
/// the session last.
#[derive(Debug)]
pub(crate) struct OpenSession {
    pub(crate) loan: Option<Loan>,
    held: [Option<(u64, Correction)>; MAX_HELD],
    repair: Option<(u64, Repair)>,
    last_token: u64,
    pub(crate) session: Session,
}

impl OpenSession {
    pub(crate) fn new(session: Session) -> Self {
        Self { loan: None, held: [const { None }; MAX_HELD], repair: None, last_token: 0, session }
    }

    /// Gives back what is held, and ends the session. A daemon that does not take note finds out by itself.
    pub(crate) fn close(self, timeout: Duration) {
        drop((self.loan, self.held, self.repair));
        let _ = self.session.close(timeout);
    }

    /// Called before a correction is received, so that none is lost.
    pub(crate) fn check_room(&self) -> Result<(), Fault> {
        if self.held.iter().any(Option::is_none) {
            return Ok(());
        }
        let message = format_args!("{MAX_HELD} corrections are held; release one");
        Err(Fault::new(ErrorCode::TooManyCorrections, message))
    }

    /// Keeps a correction for the caller, and returns it with the number to release it by.
    pub(crate) fn hold(&mut self, correction: Correction) -> Result<(u64, &Correction), Fault> {
        self.check_room()?;
        self.last_token += 1;
        let token = self.last_token;
        let slot = self.held.iter_mut().find(|slot| slot.is_none());
        let (_, held) = slot
            .map(|slot| slot.insert((token, correction)))
            .ok_or_else(|| Fault::new(ErrorCode::Internal, "no room for a correction"))?;
        Ok((token, held))
    }

    /// A correction that the caller holds.
    pub(crate) fn held(&self, token: u64) -> Result<&Correction, Fault> {
        let held = self.held.iter().flatten().find(|held| held.0 == token);
        held.map(|(_, correction)| correction).ok_or_else(not_held)
    }

    pub(crate) fn release(&mut self, token: u64) -> Result<(), Fault> {
        let slot = self.held.iter_mut().find(|slot| slot.as_ref().is_some_and(|held| held.0 == token));
        *slot.ok_or_else(not_held)? = None;
        Ok(())
    }
}

impl OpenSession {
    /// Called before a repair is received, so that none is lost.
    pub(crate) fn check_room_for_repair(&self) -> Result<(), Fault> {
        if self.repair.is_none() {
            return Ok(());
        }
        Err(Fault::new(ErrorCode::TooManyCorrections, "a repair is held; release it"))
    }

    /// Keeps a repair for the caller, and returns it with the number to release it by.
    pub(crate) fn hold_repair(&mut self, repair: Repair) -> (u64, &Repair) {
        self.last_token += 1;
        let (token, held) = self.repair.insert((self.last_token, repair));
        (*token, held)
    }

    pub(crate) fn release_repair(&mut self, token: u64) -> Result<(), Fault> {
        if self.repair.take_if(|held| held.0 == token).is_some() {
            return Ok(());
        }
        Err(Fault::new(ErrorCode::InvalidHandle, "the repair was released before, or is another session's"))
    }
}

fn not_held() -> Fault {
    Fault::new(ErrorCode::InvalidHandle, "the correction was released before, or is another session's")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_rejects_stale_handles_and_never_reuses_ids() {
        static TABLE: Table<i32> = Table::new("number");
        let (one, two) = (TABLE.add(1), TABLE.add(2));
        assert_eq!(*lock(&TABLE.get(two).unwrap()), 2);
        TABLE.remove(one).unwrap();
        assert!(TABLE.get(one).is_err() && TABLE.remove(one).is_err() && TABLE.get(0).is_err());
        assert_ne!(TABLE.add(3), one);
        assert_eq!(*lock(&TABLE.get(two).unwrap()), 2);
    }
}
