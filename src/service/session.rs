//! One session: a mesh, its ports, and the memory that its frames need.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::{Duration, Instant},
};

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher, subscriber::Subscriber},
    prelude::{EventId, Node, PortFactory, ZeroCopySend},
};
use untangled_proto::{
    CorrectionHeader, CorrectionKind, PositionF32, PositionF64, Precision, StateHeader, Status, VertexCorrection,
    correction::{NO_FAULT, stage},
    limits,
    names::{self, SessionService},
    services::{self, CorrectionService, Event, Ipc, States},
};

use crate::{
    frame::Frame,
    mesh::Mesh,
    settings::Settings,
    untangler::{Outcome, Untangler},
};

use super::{
    clock::StageClock,
    error::{Refusal, ServeError},
    ingest::{self, StateFault},
    paths::PathsPort,
    publish,
    register::Registered,
    status::Statistics,
};

/// How long a host may take from the reply to its publisher.
const GRACE: Duration = Duration::from_secs(10);

/// A host's cloth. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(super) struct Session {
    states: StatePort,
    corrections: Publisher<Ipc, [VertexCorrection], CorrectionHeader>,
    notifier: Notifier<Ipc>,
    paths: PathsPort,
    _correction_service: CorrectionService,
    _event: Event,
    id: u64,
    precision: Precision,
    correction: CorrectionKind,
    untangler: Untangler,
    frame: Frame,
    statistics: Statistics,
    had_host: bool,
    created: Instant,
}

/// Where positions come from, with the service that knows whether somebody is there to send them.
#[derive(Debug)]
enum StatePort {
    F32(Subscriber<Ipc, [PositionF32], StateHeader>, States<PositionF32>),
    F64(Subscriber<Ipc, [PositionF64], StateHeader>, States<PositionF64>),
}

impl Session {
    /// Creates the services and the daemon's ports of a session.
    pub(super) fn create(node: &Node<Ipc>, instance: u64, id: u64, registered: Registered) -> Result<Self, Refusal> {
        let internal = |error: ServeError| Refusal::new(Status::Internal, error);
        let Registered { mesh, settings, precision, correction } = registered;
        let num_vertices = mesh.num_vertices();
        let untangler = Untangler::new(mesh, settings).map_err(|error| Refusal::new(Status::BadSettings, error))?;
        let name = |service| names::session(instance, id, service);
        let states = StatePort::create(node, &name(SessionService::State), precision).map_err(internal)?;
        let (correction_service, corrections) =
            create_corrections(node, &name(SessionService::Correction), num_vertices).map_err(internal)?;
        let (event, notifier) = create_notifier(node, &name(SessionService::Event)).map_err(internal)?;
        let paths = PathsPort::create(node, instance, id).map_err(internal)?;
        Ok(Self {
            states,
            corrections,
            notifier,
            paths,
            _correction_service: correction_service,
            _event: event,
            id,
            precision,
            correction,
            untangler,
            frame: Frame::default(),
            statistics: Statistics::default(),
            had_host: false,
            created: Instant::now(),
        })
    }

    pub(super) fn id(&self) -> u64 {
        self.id
    }

    pub(super) fn mesh(&self) -> &Arc<Mesh> {
        self.untangler.mesh()
    }

    pub(super) fn precision(&self) -> Precision {
        self.precision
    }

    pub(super) fn correction(&self) -> CorrectionKind {
        self.correction
    }

    pub(super) fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Changes the settings from the next frame on.
    pub(super) fn set_settings(&mut self, settings: Settings) -> Result<(), Refusal> {
        self.untangler.set_settings(settings).map_err(|error| Refusal::new(Status::BadSettings, error))
    }

    /// Whether somebody is there to send states, or may still come.
    pub(super) fn has_host(&self) -> bool {
        let here = if self.had_host { self.states.has_publisher() } else { self.created.elapsed() < GRACE };
        if !here {
            tracing::info!(
                session = self.id,
                num_frames = self.statistics.num_frames,
                "session ended: its host is gone"
            );
        }
        here
    }

    /// Shared memory that the session may still come to use: all of it until its samples have gone round once.
    pub(super) fn untouched_bytes(&self) -> u64 {
        let round = limits::CORRECTION_BUFFER + limits::CORRECTION_BORROWED + 1;
        if self.statistics.num_frames > round as u64 {
            0
        } else {
            limits::session_bytes(self.mesh().num_vertices(), self.precision)
        }
    }

    /// Answers the newest state, if one has come.
    pub(super) fn serve(&mut self) {
        self.had_host |= self.states.has_publisher();
        let mut clock = StageClock::start();
        let Some((state, read)) = self.states.read_newest(&mut self.frame, self.untangler.mesh()) else { return };
        let span = tracing::debug_span!("frame", session = self.id, frame = state.frame);
        let _entered = span.enter();
        let header = self.answer(&state, read, &mut clock);
        self.statistics.record(&header);
        if header.status != Status::Ok.code() {
            tracing::info!(
                status = header.status,
                index = header.fault_index,
                value = header.fault_value,
                "frame refused"
            );
        }
        tracing::debug!(
            num_edge_face_intersections = header.num_edge_face_intersections,
            contour_length_m = header.contour_length_m,
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
        state: &StateHeader,
        read: Result<(), StateFault>,
        clock: &mut StageClock,
    ) -> CorrectionHeader {
        let num_skipped_frames = self.statistics.skip_to(state.frame);
        let kind = self.correction;
        let checked = read.and_then(|()| ingest::check_header(state, self.untangler.mesh().num_vertices()));
        let Self { untangler, frame, corrections: port, paths, .. } = self;
        let mesh = Arc::clone(untangler.mesh());
        let observer = &mut *clock;
        let outcome = checked.and_then(|()| {
            process_guarded(untangler, frame, observer).ok_or(StateFault {
                status: Status::Internal,
                index: NO_FAULT,
                value: 0.0,
            })
        });
        clock.begin_index(stage::PUBLISH);
        let (mut header, failed) = match outcome {
            Ok(outcome) => {
                let mut header = publish::header(state, kind, &outcome);
                header.num_skipped_frames = num_skipped_frames;
                let vertex = |index| publish::vertex(&mesh, outcome.corrections, kind, state.dt_s, index);
                send(port, mesh.num_vertices(), &mut header, clock, vertex);
                paths.publish(state.frame, &outcome.analysis.paths);
                (header, false)
            }
            Err(fault) => {
                let mut header = publish::refused(state, kind, fault);
                header.num_skipped_frames = num_skipped_frames;
                send(port, mesh.num_vertices(), &mut header, clock, |_| VertexCorrection::default());
                (header, fault.status == Status::Internal)
            }
        };
        header.num_vertices = u32::try_from(mesh.num_vertices()).unwrap_or(u32::MAX);
        if failed {
            // Whatever the panic left half done is dropped.
            let settings = self.untangler.settings().clone();
            if let Ok(fresh) = Untangler::new(mesh, settings) {
                self.untangler = fresh;
            }
        }
        // A listener that can't be reached is a host that is gone.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_CORRECTION));
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

/// Writes a correction in place and sends it; its header last, with the times up to there.
fn send(
    port: &Publisher<Ipc, [VertexCorrection], CorrectionHeader>,
    num_vertices: usize,
    header: &mut CorrectionHeader,
    clock: &mut StageClock,
    vertex: impl FnMut(usize) -> VertexCorrection,
) {
    let sent = port
        .loan_slice_uninit(num_vertices)
        .map_err(|error| ServeError::transport("loaning a correction", &error))
        .and_then(|sample| {
            let mut sample = sample.write_from_fn(vertex);
            header.stage_ns = clock.finish();
            *sample.user_header_mut() = *header;
            sample.send().map_err(|error| ServeError::transport("sending a correction", &error))
        });
    if let Err(error) = sent {
        tracing::warn!(%error, frame = header.frame, "the correction is lost");
    }
}

impl StatePort {
    fn create(node: &Node<Ipc>, name: &str, precision: Precision) -> Result<Self, ServeError> {
        Ok(match precision {
            Precision::F32 => {
                let (subscriber, service) = create_subscriber(node, name)?;
                Self::F32(subscriber, service)
            }
            Precision::F64 => {
                let (subscriber, service) = create_subscriber(node, name)?;
                Self::F64(subscriber, service)
            }
        })
    }

    fn has_publisher(&self) -> bool {
        0 != match self {
            Self::F32(_, service) => service.dynamic_config().number_of_publishers(),
            Self::F64(_, service) => service.dynamic_config().number_of_publishers(),
        }
    }

    /// The newest state that has come, copied and checked into `frame`.
    fn read_newest(&self, frame: &mut Frame, mesh: &Mesh) -> Option<(StateHeader, Result<(), StateFault>)> {
        match self {
            Self::F32(subscriber, _) => {
                let sample = newest(subscriber)?;
                Some((*sample.user_header(), ingest::read_f32(frame, mesh, sample.payload())))
            }
            Self::F64(subscriber, _) => {
                let sample = newest(subscriber)?;
                Some((*sample.user_header(), ingest::read_f64(frame, mesh, sample.payload())))
            }
        }
    }
}

/// The buffer has room for one state, the newest: what it overtook is gone.
fn newest<P: std::fmt::Debug + ZeroCopySend + 'static>(
    subscriber: &Subscriber<Ipc, [P], StateHeader>,
) -> Option<iceoryx2::sample::Sample<Ipc, [P], StateHeader>> {
    subscriber.receive().unwrap_or_else(|error| {
        tracing::warn!(?error, "receiving a state");
        None
    })
}

fn create_subscriber<P: std::fmt::Debug + ZeroCopySend + 'static>(
    node: &Node<Ipc>,
    name: &str,
) -> Result<(Subscriber<Ipc, [P], StateHeader>, States<P>), ServeError> {
    let service = services::create_states(node, name)
        .map_err(|error| ServeError::transport("creating the state service", &error))?;
    let subscriber = service
        .subscriber_builder()
        .create()
        .map_err(|error| ServeError::transport("creating a subscriber", &error))?;
    Ok((subscriber, service))
}

fn create_corrections(
    node: &Node<Ipc>,
    name: &str,
    num_vertices: usize,
) -> Result<(CorrectionService, Publisher<Ipc, [VertexCorrection], CorrectionHeader>), ServeError> {
    let service = services::create_corrections(node, name)
        .map_err(|error| ServeError::transport("creating the correction service", &error))?;
    let publisher = service
        .publisher_builder()
        .initial_max_slice_len(num_vertices)
        .max_loaned_samples(1)
        .create()
        .map_err(|error| ServeError::transport("creating a publisher", &error))?;
    Ok((service, publisher))
}

fn create_notifier(node: &Node<Ipc>, name: &str) -> Result<(Event, Notifier<Ipc>), ServeError> {
    let event = services::create_session_event(node, name)
        .map_err(|error| ServeError::transport("creating the session's event", &error))?;
    let notifier =
        event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
    Ok((event, notifier))
}
