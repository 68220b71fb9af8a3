//! Those who watch sessions, as far as the limit of open files has room for them.

use std::sync::{Arc, Mutex, PoisonError};

use untangled_proto::Status;

use crate::service::{
    descriptors::{self, DescriptorRoom},
    error::Refusal,
    session::{NewObserver, Session},
};

/// Counts observers when they come, and refuses those that there are no descriptors for: what sessions need is not
/// touched.
#[derive(Debug)]
pub(crate) struct Audience {
    room: DescriptorRoom,
    /// One observer is admitted at a time.
    admission: Mutex<()>,
}

impl Audience {
    pub(super) fn new(room: DescriptorRoom) -> Self {
        Self { room, admission: Mutex::default() }
    }

    /// Opens the views of a session to one more observer. `open` gives all open sessions.
    pub(super) fn admit(
        &self,
        open: impl FnOnce() -> Vec<Arc<Session>>,
        session: &Session,
        observer: NewObserver<'_>,
    ) -> Result<(), Refusal> {
        let _one = self.admission.lock().unwrap_or_else(PoisonError::into_inner);
        let of = |num_observers: Option<usize>| num_observers.map_or(0, descriptors::of_views);
        let own = session.num_observers();
        let more = of(Some(own.unwrap_or(0) + 1)) - of(own);
        let taken: u64 = open().iter().map(|session| of(session.num_observers())).sum();
        let DescriptorRoom { limit: Some(limit), for_observers, max_sessions } = self.room else {
            return session.open_to(observer);
        };
        if taken.saturating_add(more) > for_observers {
            return Err(Refusal::new(
                Status::TooManyObservers,
                format_args!(
                    "no room for one more observer: of the {limit} files that the daemon may have open, \
                     {for_observers} are for those who watch, the others for at most {max_sessions} sessions; an \
                     observer takes {}, the first of a session {} (raise the hard limit of open files, or lower \
                     limits.max_sessions)",
                    descriptors::of_views(1) - descriptors::of_views(0),
                    descriptors::of_views(1),
                ),
            ));
        }
        session.open_to(observer)
    }
}
