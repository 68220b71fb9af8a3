//! One session: a mesh, its ports, and the memory that its frames need.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::{Duration, Instant},
};

use iceoryx2::prelude::Node;
use untangled_proto::{
    CorrectionHeader, CorrectionKind, Precision, StateHeader, Status, VertexCorrection,
    correction::{NO_FAULT, stage},
    limits,
    services::Ipc,
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
    ports::{CorrectionPort, StatePort},
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
    corrections: CorrectionPort,
    paths: PathsPort,
    id: u64,
    precision: Precision,
    correction: CorrectionKind,
    untangler: Untangler,
    frame: Frame,
    statistics: Statistics,
    had_host: bool,
    created: Instant,
}

impl Session {
    /// Creates the services and the daemon's ports of a session.
    pub(super) fn create(node: &Node<Ipc>, instance: u64, id: u64, registered: Registered) -> Result<Self, Refusal> {
        let internal = |error: ServeError| Refusal::new(Status::Internal, error);
        let Registered { mesh, settings, precision, correction } = registered;
        let num_vertices = mesh.num_vertices();
        let untangler = Untangler::new(mesh, settings).map_err(|error| Refusal::new(Status::BadSettings, error))?;
        let states = StatePort::create(node, instance, id, precision).map_err(internal)?;
        let corrections = CorrectionPort::create(node, instance, id, num_vertices).map_err(internal)?;
        let paths = PathsPort::create(node, instance, id).map_err(internal)?;
        Ok(Self {
            states,
            corrections,
            paths,
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
        let Self { untangler, frame, corrections: port, paths, correction: kind, .. } = self;
        let (kind, mesh) = (*kind, Arc::clone(untangler.mesh()));
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
        header.num_skipped_frames = num_skipped_frames;
        let sent = match &outcome {
            Ok(outcome) => port
                .send(&mut header, clock, |index| publish::vertex(&mesh, outcome.corrections, kind, state.dt_s, index)),
            Err(_) => port.send(&mut header, clock, |_| VertexCorrection::default()),
        };
        if let Err(error) = sent {
            tracing::warn!(%error, "the correction is lost");
        }
        match outcome {
            Ok(outcome) => paths.publish(state.frame, &outcome.analysis.paths),
            Err(StateFault { status: Status::Internal, .. }) => {
                // Whatever the panic left half done is dropped. Settings that were valid still are.
                if let Ok(fresh) = Untangler::new(mesh, self.untangler.settings().clone()) {
                    self.untangler = fresh;
                }
            }
            Err(_) => {}
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
