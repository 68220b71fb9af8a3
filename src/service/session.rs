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
//! The thread that waits for events moves a session out of idle, and the worker that has it moves it back: so a session's [`Work`]
//! belongs to one worker at a time, and no state that comes is overlooked.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use iceoryx2::prelude::Node;
use untangled_proto::{CorrectionHeader, CorrectionKind, Precision, StateHeader, Status, VertexCorrection, correction::{NO_FAULT, stage}, limits};
use untangled_transport::{Domain, services::Ipc};

use untangle::{frame::Frame, mesh::Mesh, settings::Settings, untangler::{Outcome, Untangler}};

use super::{
    clock::StageClock,
    error::{Refusal, ServeError},
    ingest::{self, StateFault},
    paths::PathsPort,
    ports::{CorrectionPort, StatePort},
    publish,
    register::Registered,
    status::Statistics,
    throttle::Throttle,
};

/// How long a host may take from the reply to its publisher.
const GRACE: Duration = Duration::from_secs(10);
/// Meshes with more faces than this are large from their first frame on.
const LARGE_FACES: usize = 20_000;
/// A session whose last frame took longer than this is large as well, in nanoseconds.
const LARGE_NS: u64 = 20_000_000;

const IDLE: u8 = 0;
const QUEUED: u8 = 1;
const AGAIN: u8 = 2;

/// A host's cloth. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(super) struct Session {
    states: StatePort,
    work: Mutex<Work>,
    id: u64,
    mesh: Arc<Mesh>,
    precision: Precision,
    correction: CorrectionKind,
    phase: AtomicU8,
    /// Settings to take over before the next frame.
    settings: Mutex<Option<Settings>>,
    statistics: Mutex<Statistics>,
    last_ns: AtomicU64,
    had_host: AtomicBool,
    created: Instant,
}

/// What a worker needs for a frame.
#[derive(Debug)]
struct Work {
    corrections: CorrectionPort,
    paths: PathsPort,
    untangler: Untangler,
    frame: Frame,
    num_skipped_frames: u64,
    last_frame: Option<u64>,
}

impl Session {
    /// Creates the services and the daemon's ports of a session.
    pub(super) fn create(
        node: &Node<Ipc>,
        domain: &Domain,
        instance: u64,
        id: u64,
        registered: Registered,
    ) -> Result<Self, Refusal> {
        let internal = |error: ServeError| Refusal::new(Status::Internal, error);
        let Registered { mesh, settings, precision, correction } = registered;
        let untangler =
            Untangler::new(Arc::clone(&mesh), settings).map_err(|error| Refusal::new(Status::BadSettings, error))?;
        let states = StatePort::create(node, instance, id, precision).map_err(internal)?;
        let corrections = CorrectionPort::create(node, domain, instance, id, mesh.num_vertices())?;
        let paths = PathsPort::create(node, instance, id).map_err(internal)?;
        let work =
            Work { corrections, paths, untangler, frame: Frame::default(), num_skipped_frames: 0, last_frame: None };
        Ok(Self {
            states,
            work: Mutex::new(work),
            id,
            mesh,
            precision,
            correction,
            phase: AtomicU8::new(IDLE),
            settings: Mutex::new(None),
            statistics: Mutex::default(),
            last_ns: AtomicU64::new(0),
            had_host: AtomicBool::new(false),
            created: Instant::now(),
        })
    }

    pub(super) fn id(&self) -> u64 {
        self.id
    }

    pub(super) fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    pub(super) fn precision(&self) -> Precision {
        self.precision
    }

    pub(super) fn correction(&self) -> CorrectionKind {
        self.correction
    }

    pub(super) fn statistics(&self) -> Statistics {
        lock(&self.statistics).clone()
    }

    /// Changes the settings from the next frame on.
    pub(super) fn set_settings(&self, settings: Settings) -> Result<(), Refusal> {
        settings.validate().map_err(|error| Refusal::new(Status::BadSettings, error))?;
        *lock(&self.settings) = Some(settings);
        Ok(())
    }

    /// Whether somebody is there to send states, or may still come.
    pub(super) fn has_host(&self) -> bool {
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
    pub(super) fn promised_bytes(&self) -> u64 {
        if self.had_host.load(Ordering::Relaxed) {
            0
        } else {
            limits::state_segment_bytes(self.mesh.num_vertices(), self.precision)
        }
    }

    /// Whether a frame may take so long that small sessions must not wait for it.
    pub(super) fn is_large(&self) -> bool {
        self.mesh.num_faces() > LARGE_FACES || self.last_ns.load(Ordering::Relaxed) > LARGE_NS
    }

    /// Looks for a state; whether the session is to be queued. For the one thread that waits for events.
    pub(super) fn wake(&self) -> bool {
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
                // Whether it was an event of this session is not known; the worker looks again.
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

    /// Answers the newest state, if one has come; whether the session is to be queued again. For the worker that has it.
    pub(super) fn serve(&self) -> bool {
        lock(&self.work).serve(self);
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
}

impl Work {
    fn serve(&mut self, session: &Session) {
        if let Some(settings) = lock(&session.settings).take()
            && let Err(error) = self.untangler.set_settings(settings)
        {
            tracing::error!(%error, "settings that were checked are refused");
        }
        let mut clock = StageClock::start(self.untangler.settings().deadline_us.map(Duration::from_micros));
        let Some((state, read)) = session.states.read_newest(&mut self.frame, &session.mesh) else { return };
        let span = tracing::debug_span!("frame", session = session.id, frame = state.frame);
        let _entered = span.enter();
        let header = self.answer(session, &state, read, &mut clock);
        session.last_ns.store(header.stage_ns[stage::TOTAL], Ordering::Relaxed);
        if header.status != Status::Ok.code() {
            static REFUSED: Throttle = Throttle::new();
            if let Some(num_suppressed) = REFUSED.admit() {
                tracing::info!(
                    session = session.id,
                    frame = state.frame,
                    status = header.status,
                    index = header.fault_index,
                    value = header.fault_value,
                    num_suppressed,
                    "frame refused"
                );
            }
        }
        tracing::debug!(
            num_edge_face_intersections = header.num_edge_face_intersections,
            contour_length_m = header.contour_length_m,
            num_pairs_left_out = header.num_pairs_left_out,
            ingest_ns = header.stage_ns[stage::INGEST],
            intersect_ns = header.stage_ns[stage::INTERSECT],
            paths_ns = header.stage_ns[stage::PATHS],
            regions_ns = header.stage_ns[stage::REGIONS],
            correspond_ns = header.stage_ns[stage::CORRESPOND],
            respond_ns = header.stage_ns[stage::RESPOND],
            publish_ns = header.stage_ns[stage::PUBLISH],
            total_ns = header.stage_ns[stage::TOTAL],
            "corrected"
        );
    }

    fn answer(
        &mut self,
        session: &Session,
        state: &StateHeader,
        read: Result<(), StateFault>,
        clock: &mut StageClock,
    ) -> CorrectionHeader {
        if let Some(last) = self.last_frame.replace(state.frame) {
            let skipped = state.frame.saturating_sub(last).saturating_sub(1);
            self.num_skipped_frames = self.num_skipped_frames.saturating_add(skipped);
        }
        let Self { untangler, frame, corrections: port, paths, .. } = self;
        let (kind, mesh) = (session.correction, &session.mesh);
        let checked = read.and_then(|()| ingest::check_header(state, mesh.num_vertices()));
        let outcome = checked.and_then(|()| {
            process_guarded(untangler, frame, clock).ok_or(StateFault {
                status: Status::Internal,
                index: NO_FAULT,
                value: 0.0,
            })
        });
        clock.begin_index(stage::PUBLISH);
        let mut header = match &outcome {
            Ok(outcome) => publish::header(state, kind, outcome),
            Err(fault) => publish::refused(state, kind, *fault),
        };
        header.num_vertices = u32::try_from(mesh.num_vertices()).unwrap_or(u32::MAX);
        header.num_skipped_frames = self.num_skipped_frames;
        let record = |header: &CorrectionHeader| lock(&session.statistics).record(header);
        // Before the correction, so that a host which has that finds its paths.
        if let Ok(outcome) = &outcome {
            paths.publish(state.frame, &outcome.analysis.paths);
        }
        let sent = match &outcome {
            Ok(outcome) => port.send(&mut header, clock, record, |index| {
                publish::vertex(mesh, outcome.corrections, kind, state.dt_s, index)
            }),
            Err(_) => port.send(&mut header, clock, record, |_| VertexCorrection::default()),
        };
        if let Err(error) = sent {
            static LOST: Throttle = Throttle::new();
            if let Some(num_suppressed) = LOST.admit() {
                tracing::warn!(%error, session = session.id, num_suppressed, "the correction is lost");
            }
        }
        if matches!(outcome, Err(StateFault { status: Status::Internal, .. }))
            // Whatever the panic left half done is dropped. Settings that were valid still are.
            && let Ok(fresh) = Untangler::new(Arc::clone(mesh), self.untangler.settings().clone())
        {
            self.untangler = fresh;
        }
        header
    }
}

/// Processes a frame; nothing if that panicked. A bug that a strange mesh brings out must not end the sessions of others.
fn process_guarded<'a>(untangler: &'a mut Untangler, frame: &'a Frame, clock: &mut StageClock) -> Option<Outcome<'a>> {
    catch_unwind(AssertUnwindSafe(|| {
        // Moved, so that the outcome may outlive the closure.
        let untangler = untangler;
        untangler.process(frame, clock)
    }))
    .ok()
}

/// Whoever panicked while it held one of these locks left nothing half done that matters.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
