//! One session: a mesh, its ports, and the memory that its frames need.
//!
//! ```text
//!          a state has come             taken by a worker, done, nothing new has come
//!  Idle ----------------------> Queued -----------------------------------------------> Idle
//!                                 ^  |  woken meanwhile
//!                                 |  v
//!                                 Again    (done, and to the end of the queue)
//! ```
//!
//! The thread that waits for events moves a session out of idle, and the worker that has it moves it back. So the
//! work of a session belongs to one worker at a time, and no state is overlooked.

mod clock;
mod cloth;
mod estimate;
pub mod ingest;
mod pace;
mod ports;
pub mod publish;
mod registered;
mod statistics;
mod watched;
mod work;

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU8, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::prelude::Node;
use untangle::{settings::Settings, untangler::Untangler};
use untangled_proto::{CorrectionKind, PayloadLayout, Precision, Status, memory};
use untangled_transport::{Domain, process_id::ProcessId, services::Ipc, throttle::Throttle};

use super::{
    error::{Refusal, ServeError},
    port_options::PortOptions,
    repair::{Counts, RepairDesk, RepairPort, RepairWorkers},
};
pub use cloth::Cloth;
pub use estimate::memory_bytes;
use pace::{Pace, processor_ns};
use ports::{CorrectionPort, StatePort};
pub use registered::Registered;
pub(crate) use statistics::{Statistics, Totals};
pub(crate) use watched::{NewObserver, Observer};
use watched::{PathsPort, ViewDesk, ViewPort, mesh_bytes};
use work::{Ports, SessionRepairs, Work};

/// How long a host may take from the reply to the creation of its publisher.
const GRACE: Duration = Duration::from_secs(10);

const IDLE: u8 = 0;
const QUEUED: u8 = 1;
const AGAIN: u8 = 2;

/// What the sessions of a daemon share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shared<'a> {
    pub(crate) totals: &'a Arc<Totals>,
    pub(crate) workers: &'a Arc<RepairWorkers>,
}

/// A host's cloth. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(crate) struct Session {
    states: StatePort,
    work: Mutex<Work>,
    /// The repairs, which `work` asks for.
    repairs: Option<Arc<RepairDesk>>,
    /// Who watches; `work` publishes the views.
    views: Arc<ViewDesk>,
    id: u64,
    /// The process that registered it.
    client: Option<ProcessId>,
    cloth: Arc<Cloth>,
    precision: Precision,
    correction: CorrectionKind,
    layout: PayloadLayout,
    phase: AtomicU8,
    /// Settings to take over before the next frame.
    settings: Mutex<Option<Settings>>,
    statistics: Mutex<Statistics>,
    /// Those of all sessions.
    totals: Arc<Totals>,
    pace: Pace,
    had_host: AtomicBool,
    created: Instant,
}

impl Session {
    /// Creates the services and the daemon's ports of a session.
    pub(crate) fn create(
        node: &Node<Ipc>,
        domain: &Domain,
        instance: u64,
        id: u64,
        client: Option<ProcessId>,
        registered: Registered,
        shared: Shared<'_>,
    ) -> Result<Self, Refusal> {
        let internal = |error: ServeError| Refusal::new(Status::Internal, error);
        let Registered { cloth, settings, precision, correction, layout, options } = registered;
        let mut untangler = Untangler::new(Arc::clone(cloth.mesh()), settings)
            .map_err(|error| Refusal::new(Status::BadSettings, error))?;
        untangler.set_labelled(options.has_labels());
        untangler.set_single_precision(precision == Precision::F32);
        untangler.set_displaced(correction == CorrectionKind::Displacement);
        let states = StatePort::create(node, instance, id, precision, layout).map_err(internal)?;
        let (num_vertices, pace) = (cloth.num_vertices(), Pace::new(cloth.mesh().num_faces()));
        let port = PortOptions { domain, instance, session: id, num_vertices, precision, layout, options };
        let corrections = CorrectionPort::create(node, &port)?;
        let paths = PathsPort::create(node, instance, id, layout).map_err(internal)?;
        let repairs = if options.has_repairs() {
            shared.workers.start().map_err(|error| {
                Refusal::new(Status::Internal, format_args!("starting a thread for repairs: {error}"))
            })?;
            let port = RepairPort::create(node, corrections.event(), &port)?;
            let totals = Arc::clone(shared.workers.totals());
            Some(Arc::new(RepairDesk::new(id, Arc::clone(&cloth), precision, port, totals)))
        } else {
            None
        };
        let asked = repairs.clone().map(|desk| SessionRepairs { desk, workers: Arc::clone(shared.workers) });
        let views = Arc::new(ViewDesk::default());
        let ports = Ports { corrections, paths, views: ViewPort::new(Arc::clone(&views)), repairs: asked };
        let work = Work::new(id, correction, Arc::clone(&cloth), untangler, ports);
        Ok(Self {
            states,
            work: Mutex::new(work),
            repairs,
            views,
            id,
            client,
            cloth,
            precision,
            correction,
            layout,
            phase: AtomicU8::new(IDLE),
            settings: Mutex::new(None),
            statistics: Mutex::default(),
            totals: Arc::clone(shared.totals),
            pace,
            had_host: AtomicBool::new(false),
            created: Instant::now(),
        })
    }

    pub(crate) fn id(&self) -> u64 {
        self.id
    }

    pub(crate) fn client(&self) -> Option<ProcessId> {
        self.client
    }

    /// Whether no host has sent or could have sent a state yet.
    pub(crate) fn is_waiting(&self) -> bool {
        !self.had_host.load(Ordering::Relaxed)
    }

    pub(crate) fn cloth(&self) -> &Arc<Cloth> {
        &self.cloth
    }

    pub(crate) fn precision(&self) -> Precision {
        self.precision
    }

    pub(crate) fn correction(&self) -> CorrectionKind {
        self.correction
    }

    pub(crate) fn statistics(&self) -> Statistics {
        lock(&self.statistics).clone()
    }

    /// Counts of its repairs, where it asked for them.
    pub(crate) fn repairs(&self) -> Option<Counts> {
        self.repairs.as_ref().map(|desk| desk.counts())
    }

    /// Lets one more watch. From now on it publishes views while somebody subscribes.
    pub(crate) fn open_to(&self, observer: NewObserver<'_>) -> Result<(), Refusal> {
        self.views.open(self.id, observer).map_err(|error| Refusal::new(Status::Internal, error))
    }

    /// How many watch, those that have asked just now included; none where nobody has asked ever.
    pub(crate) fn num_observers(&self) -> Option<usize> {
        self.views.num_expected()
    }

    /// Its mesh as bytes, for those who watch.
    pub(crate) fn mesh_for_observers(&self) -> &[u8] {
        self.views.mesh(|| mesh_bytes(&self.cloth, self.precision, self.correction))
    }

    /// Who watches it.
    pub(crate) fn observers(&self) -> Vec<Observer> {
        self.views.observers()
    }

    /// Changes the settings from the next frame on.
    pub(crate) fn set_settings(&self, settings: Settings) -> Result<(), Refusal> {
        settings.validate().map_err(|error| Refusal::new(Status::BadSettings, error))?;
        *lock(&self.settings) = Some(settings);
        Ok(())
    }

    /// Whether a host is there to send states, or may still come.
    pub(crate) fn has_host(&self) -> bool {
        static ENDED: Throttle = Throttle::new();
        let had_host = self.had_host.load(Ordering::Relaxed);
        let here = if had_host { self.states.has_publisher() } else { self.created.elapsed() < GRACE };
        if !here && let Some(num_suppressed) = ENDED.admit() {
            let num_frames = lock(&self.statistics).num_frames;
            tracing::info!(session = self.id, num_frames, num_suppressed, "session ended: its host is gone");
        }
        here
    }

    /// Shared memory that the host has yet to take.
    pub(crate) fn promised_bytes(&self) -> u64 {
        if self.had_host.load(Ordering::Relaxed) {
            0
        } else {
            memory::state_segment_bytes(self.cloth.num_vertices(), self.precision, self.layout)
        }
    }

    /// Whether a frame may take so long that small sessions must not wait for it.
    pub(crate) fn is_large(&self) -> bool {
        self.pace.is_large()
    }

    /// Whether a frame takes about as long as waking another thread for it, going by the last ones.
    pub(crate) fn is_brief(&self, has_others: bool) -> bool {
        self.pace.is_brief(has_others)
    }

    /// Checks for a new state; whether the session is to be queued. For the one thread that waits for events.
    pub(crate) fn wake(&self) -> bool {
        if !self.had_host.load(Ordering::Relaxed) && self.states.has_publisher() {
            self.had_host.store(true, Ordering::Relaxed);
        }
        loop {
            match self.phase.load(Ordering::Acquire) {
                IDLE => {
                    let waiting = self.states.has_state();
                    if waiting {
                        self.phase.store(QUEUED, Ordering::Release);
                    }
                    return waiting;
                }
                // It is not known whether the event was this session's, so the worker checks again.
                QUEUED => {
                    let changed = self.phase.compare_exchange(QUEUED, AGAIN, Ordering::AcqRel, Ordering::Acquire);
                    if changed.is_ok() {
                        return false;
                    }
                }
                _ => return false,
            }
        }
    }

    /// Answers the newest state, if one has come; whether the session is to be queued again. For the worker that has
    /// it.
    pub(crate) fn serve(&self) -> bool {
        self.serve_frame();
        loop {
            if self.phase.compare_exchange(QUEUED, IDLE, Ordering::AcqRel, Ordering::Acquire).is_ok() {
                return false;
            }
            self.phase.store(QUEUED, Ordering::Release);
            if self.states.has_state() {
                return true;
            }
        }
    }

    /// How long the view of its last frame has to wait yet, if it waits; at zero it is the caller's to have it
    /// [published](Self::publish_late_view).
    pub(crate) fn take_late_view(&self) -> Option<Duration> {
        self.views.take_due()
    }

    /// Publishes the view of its last frame, which had to wait. A frame that is in work publishes its own.
    pub(crate) fn publish_late_view(&self) {
        if let Ok(mut work) = self.work.try_lock() {
            work.publish_late_view();
        }
    }

    fn serve_frame(&self) {
        let mut work = lock(&self.work);
        if let Some(settings) = lock(&self.settings).take() {
            work.set_settings(settings);
        }
        let record = |header: &_| lock(&self.statistics).record(header, &self.totals);
        let begin_ns = processor_ns();
        if work.serve(&self.states, record).is_some() {
            self.pace.record(processor_ns() - begin_ns);
        }
    }
}

/// A panic while one of these locks is held leaves no inconsistent state that matters, so a poisoned lock is used on.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
