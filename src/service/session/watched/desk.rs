//! Who watches a session: the services of its views, and the names of its observers.

use std::{
    sync::{
        Mutex, OnceLock, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use iceoryx2::{
    port::notifier::Notifier,
    prelude::{EventId, Node, PortFactory},
};
use untangled_proto::{
    limits::MAX_OBSERVERS,
    names::{self, SessionService},
};
use untangled_transport::{
    clock,
    process_id::ProcessId,
    services::{
        Event, Ipc,
        views::{self, Views},
    },
};

use crate::service::error::ServeError;

/// Most names that are kept: of observers, and of some that have asked and do not watch yet.
const MAX_NAMES: usize = 2 * MAX_OBSERVERS;

/// Who has asked subscribes within this time, or is counted no more.
const ON_ITS_WAY: Duration = Duration::from_secs(5);

/// What the request thread and the worker of a session share about its observers.
#[derive(Debug, Default)]
pub(crate) struct ViewDesk {
    services: OnceLock<Services>,
    /// The mesh as observers get it, once somebody has asked: they fetch it in parts.
    mesh: OnceLock<Vec<u8>>,
    /// When the view of the last frame is to be published, if no other frame comes before: nanoseconds of the clock of
    /// all processes; 0 where there is none to be published.
    due_ns: AtomicU64,
    /// What observers call themselves.
    names: Mutex<Vec<(ProcessId, String)>>,
    expected: Mutex<Option<Expected>>,
}

/// One that asks to watch: the daemon's node and run, its process, what it calls itself.
pub(crate) struct NewObserver<'a> {
    pub(crate) node: &'a Node<Ipc>,
    pub(crate) instance: u64,
    pub(crate) asked_by: Option<ProcessId>,
    pub(crate) name: Option<String>,
}

/// How many observers there will be when all have come that have asked.
#[derive(Clone, Copy, Debug)]
struct Expected {
    count: usize,
    /// By the clock of all processes.
    until: Duration,
}

/// Fields are dropped in order: the port before its service. The notifier shows observers that the session lives.
#[derive(Debug)]
struct Services {
    notifier: Notifier<Ipc>,
    _event: Event,
    views: Views,
}

/// One that watches.
#[derive(Clone, Debug)]
pub(crate) struct Observer {
    pub(crate) process: ProcessId,
    pub(crate) name: String,
}

impl ViewDesk {
    /// Makes the services, if nobody has asked before, and notes who has asked.
    pub(crate) fn open(&self, session: u64, observer: NewObserver<'_>) -> Result<(), ServeError> {
        let NewObserver { node, instance, asked_by, name } = observer;
        // The lock lets one thread at a time make the services.
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        if self.services.get().is_none() {
            let services = Services::create(node, &names::session(instance, session, SessionService::View))?;
            let _ = self.services.set(services);
        }
        let count = self.num_expected().unwrap_or(0) + 1;
        let mut expected = self.expected.lock().unwrap_or_else(PoisonError::into_inner);
        *expected = Some(Expected { count: count.min(MAX_OBSERVERS), until: clock::monotonic() + ON_ITS_WAY });
        drop(expected);
        if let (Some(process), Some(name)) = (asked_by, name) {
            names.retain(|(other, _)| *other != process);
            names.push((process, name));
            let excess = names.len().saturating_sub(MAX_NAMES);
            names.drain(..excess);
        }
        Ok(())
    }

    /// How many watch: those that subscribe, or as many as there will be when those that have asked just now do. None
    /// where nobody has asked ever.
    pub(crate) fn num_expected(&self) -> Option<usize> {
        let num_here = self.views()?.dynamic_config().number_of_subscribers();
        let expected = self.expected.lock().unwrap_or_else(PoisonError::into_inner);
        let recent = expected.filter(|expected| clock::monotonic() < expected.until);
        Some(recent.map_or(0, |expected| expected.count).max(num_here))
    }

    /// The mesh as observers get it; `make` makes it for the first one.
    pub(crate) fn mesh(&self, make: impl FnOnce() -> Vec<u8>) -> &[u8] {
        self.mesh.get_or_init(make)
    }

    /// The service of views, once somebody has asked for it.
    pub(crate) fn views(&self) -> Option<&Views> {
        self.services.get().map(|services| &services.views)
    }

    /// Wakes observers.
    pub(crate) fn announce(&self) {
        if let Some(services) = self.services.get() {
            // An error means that an observer is gone.
            let _ = services.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_VIEW));
        }
    }

    /// The view of the last frame waits until `due`.
    pub(crate) fn postpone(&self, due: Duration) {
        self.due_ns.store(u64::try_from(due.as_nanos()).unwrap_or(u64::MAX), Ordering::Release);
    }

    /// Nothing waits any more.
    pub(crate) fn clear(&self) {
        self.due_ns.store(0, Ordering::Release);
    }

    /// How long the view of the last frame has to wait yet; none where there is none, or somebody has taken it. One
    /// that need not wait is taken.
    pub(crate) fn take_due(&self) -> Option<Duration> {
        let due_ns = self.due_ns.load(Ordering::Acquire);
        if due_ns == 0 {
            return None;
        }
        let left = Duration::from_nanos(due_ns).saturating_sub(clock::monotonic());
        let is_taken =
            left.is_zero() && self.due_ns.compare_exchange(due_ns, 0, Ordering::AcqRel, Ordering::Acquire).is_err();
        (!is_taken).then_some(left)
    }

    /// Who watches now. Those that did not say what they are called have the name of their program.
    pub(crate) fn observers(&self) -> Vec<Observer> {
        let Some(views) = self.views() else { return Vec::new() };
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let name = |process| match names.iter().find(|(other, _)| *other == process) {
            Some((_, name)) => name.clone(),
            None => process.name().unwrap_or_default(),
        };
        views::observers(views).into_iter().map(|process| Observer { process, name: name(process) }).collect()
    }
}

impl Services {
    fn create(node: &Node<Ipc>, name: &str) -> Result<Self, ServeError> {
        let event = views::create_view_event(node, name)
            .map_err(|error| ServeError::transport("creating the event of views", &error))?;
        let views = views::create_views(node, name)
            .map_err(|error| ServeError::transport("creating the service of views", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
        Ok(Self { notifier, _event: event, views })
    }
}
