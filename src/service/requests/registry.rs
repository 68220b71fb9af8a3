//! The open sessions of a daemon: opens, finds and closes them.

use std::{
    collections::hash_map::RandomState,
    hash::BuildHasher,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::prelude::Node;
use untangled_proto::{PayloadLayout, Status, sections::Sections};
use untangled_transport::{node, process_id::ProcessId, services::Ipc, throttle::Throttle};

use super::{audience::Audience, registration};
use crate::service::{
    descriptors::DescriptorRoom,
    error::Refusal,
    options::ServeOptions,
    repair::{Counts, RepairWorkers},
    session::{Cloth, Session, Shared, Totals},
};

/// Most sessions of one client that wait for its state publisher, which a client makes right after the reply.
const MAX_WAITING: usize = 16;

/// State that all threads of a daemon share. Fields are dropped in order: sessions, whose repairs end
/// with them, before the threads of repairs, and these before the node.
#[derive(Debug)]
pub(crate) struct Registry {
    sessions: Mutex<Vec<Arc<Session>>>,
    workers: Arc<RepairWorkers>,
    node: Arc<Node<Ipc>>,
    options: ServeOptions,
    audience: Audience,
    /// Tells this run of the daemon from any other.
    instance: u64,
    num_registered: AtomicU64,
    num_registering: AtomicUsize,
    num_refused_requests: AtomicU64,
    totals: Arc<Totals>,
    started: Instant,
}

impl Registry {
    pub(crate) fn new(node: Arc<Node<Ipc>>, options: ServeOptions, room: DescriptorRoom) -> Self {
        Self {
            sessions: Mutex::default(),
            workers: Arc::new(RepairWorkers::new(options.num_repair_workers, options.num_workers())),
            node,
            options,
            audience: Audience::new(room),
            instance: RandomState::new().hash_one(std::process::id()),
            num_registered: AtomicU64::new(0),
            num_registering: AtomicUsize::new(0),
            num_refused_requests: AtomicU64::new(0),
            totals: Arc::default(),
            started: Instant::now(),
        }
    }

    pub(crate) fn options(&self) -> &ServeOptions {
        &self.options
    }

    pub(crate) fn audience(&self) -> &Audience {
        &self.audience
    }

    pub(crate) fn node(&self) -> &Node<Ipc> {
        &self.node
    }

    pub(crate) fn instance(&self) -> u64 {
        self.instance
    }

    pub(crate) fn uptime(&self) -> Duration {
        self.started.elapsed()
    }

    /// Counts of the repairs of all sessions, those that have ended included.
    pub(crate) fn repairs(&self) -> Counts {
        self.workers.totals().counts()
    }

    /// Counts and times of all sessions, those that have ended included.
    pub(crate) fn totals(&self) -> &Totals {
        &self.totals
    }

    pub(crate) fn num_registered(&self) -> u64 {
        self.num_registered.load(Ordering::Relaxed)
    }

    pub(crate) fn num_refused_requests(&self) -> u64 {
        self.num_refused_requests.load(Ordering::Relaxed)
    }

    pub(crate) fn count_refused_request(&self) {
        self.num_refused_requests.fetch_add(1, Ordering::Relaxed);
    }

    /// The open sessions, locked. All threads wait for this lock: hold it for a short time only.
    pub(crate) fn sessions(&self) -> MutexGuard<'_, Vec<Arc<Session>>> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn find(&self, id: u64) -> Result<Arc<Session>, Refusal> {
        let sessions = self.sessions();
        let found = sessions.iter().find(|session| session.id() == id).map(Arc::clone);
        found.ok_or_else(|| Refusal::new(Status::UnknownSession, format_args!("there is no session {id}")))
    }

    /// Ends a session; a frame in work is still answered.
    pub(crate) fn close(&self, id: u64) -> Result<(), Refusal> {
        static CLOSED: Throttle = Throttle::new();
        let session = self.find(id)?;
        self.sessions().retain(|other| !Arc::ptr_eq(other, &session));
        if let Some(num_suppressed) = CLOSED.admit() {
            tracing::info!(session = id, num_suppressed, "session closed");
        }
        Ok(())
    }

    /// Opens a session. Gives back its id, and its cloth.
    pub(crate) fn register(
        &self,
        sections: &Sections<'_>,
        layout: PayloadLayout,
        client: Option<ProcessId>,
    ) -> Result<(u64, Arc<Cloth>), Refusal> {
        static REGISTERED: Throttle = Throttle::new();
        let _place = self.take_place(client)?;
        let promised = self.sessions().iter().map(|session| session.promised_bytes()).sum();
        let registered = registration::read(sections, &self.options, layout, promised)?;
        let id = self.num_registered.fetch_add(1, Ordering::Relaxed) + 1;
        let shared = Shared { totals: &self.totals, workers: &self.workers };
        let session = Session::create(&self.node, &self.options.domain, self.instance, id, client, registered, shared)?;
        if let Some(num_suppressed) = REGISTERED.admit() {
            tracing::info!(
                session = id,
                num_vertices = session.cloth().num_vertices(),
                num_faces = session.cloth().mesh().num_faces(),
                num_suppressed,
                "session registered"
            );
        }
        let cloth = Arc::clone(session.cloth());
        self.sessions().push(Arc::new(session));
        Ok((id, cloth))
    }

    /// A place for one more session, while it is being registered.
    fn take_place(&self, client: Option<ProcessId>) -> Result<Place<'_>, Refusal> {
        let ServeOptions { max_sessions, max_sessions_per_client: max_own, .. } = self.options;
        let sessions = self.sessions();
        let place = Place::take(&self.num_registering);
        let refused = |words: std::fmt::Arguments<'_>| Err(Refusal::new(Status::TooManySessions, words));
        let own = || sessions.iter().filter(|session| session.client() == client);
        let num_waiting = own().filter(|session| session.is_waiting()).count();
        if num_waiting >= MAX_WAITING {
            return refused(format_args!("{num_waiting} sessions of this client still wait for its state publisher"));
        }
        if own().count() >= max_own {
            return refused(format_args!("{max_own} sessions of this client are open already"));
        }
        if sessions.len() + self.num_registering.load(Ordering::Relaxed) > max_sessions {
            return refused(format_args!("{max_sessions} sessions are open already"));
        }
        Ok(place)
    }

    /// Ends sessions whose client has ended before it made its state publisher.
    pub(crate) fn end_abandoned(&self) {
        if !self.sessions().iter().any(|session| session.is_waiting()) {
            return;
        }
        let Ok(nodes) =
            self.options.domain.config().map_err(drop).and_then(|config| node::living(&config).map_err(drop))
        else {
            return;
        };
        let living: Vec<ProcessId> = nodes.into_iter().filter_map(ProcessId::of).collect();
        let is_gone = |session: &Session| session.client().is_some_and(|client| !living.contains(&client));
        self.sessions().retain(|session| {
            let ends = session.is_waiting() && is_gone(session);
            if ends {
                static ENDED: Throttle = Throttle::new();
                if let Some(num_suppressed) = ENDED.admit() {
                    tracing::info!(session = session.id(), num_suppressed, "session ended: its client is gone");
                }
            }
            !ends
        });
    }
}

/// Counts a session that is being registered for as long as it lives.
struct Place<'a>(&'a AtomicUsize);

impl<'a> Place<'a> {
    fn take(count: &'a AtomicUsize) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(count)
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
