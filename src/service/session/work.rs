//! One frame of a session: read the newest state, process it, publish its correction.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::Duration,
};

use untangle::{
    frame::Frame,
    intersect::SearchEnd,
    settings::Settings,
    untangler::{Outcome, Untangler},
};
use untangled_proto::{
    CorrectionHeader, CorrectionKind, StateHeader, Status,
    correction::{NO_FAULT, TRUNCATED, stage},
};
use untangled_transport::throttle::Throttle;

use super::{
    clock::StageClock,
    cloth::Cloth,
    ingest::{self, StateFault},
    ports::{CorrectionPort, StatePort},
    publish::{self, Touched, TouchedMemory, Values},
    watched::{PathsPort, View, ViewPort},
};
use crate::service::{
    error::ServeError,
    repair::{RepairDesk, RepairWorkers},
};

/// The fault of a frame whose processing panicked.
const PANICKED: StateFault = StateFault { status: Status::Internal, index: NO_FAULT, value: 0.0 };

/// What a worker needs for a frame.
#[derive(Debug)]
pub(crate) struct Work {
    ports: Ports,
    /// The last frame, where its view has to wait.
    late_view: Option<LateView>,
    untangler: Untangler,
    frame: Frame,
    /// Positions of the host's vertices, where these are welded.
    copied: Vec<[f64; 3]>,
    touched: TouchedMemory,
    cloth: Arc<Cloth>,
    session: u64,
    correction: CorrectionKind,
    num_skipped_frames: u64,
    last_frame: Option<u64>,
}

impl Work {
    /// The work of the session with this id; `ports` are its ports.
    pub(crate) fn new(
        session: u64,
        correction: CorrectionKind,
        cloth: Arc<Cloth>,
        untangler: Untangler,
        ports: Ports,
    ) -> Self {
        let (frame, copied, touched) = (Frame::default(), Vec::new(), TouchedMemory::default());
        let (num_skipped_frames, last_frame) = (0, None);
        Self {
            ports,
            late_view: None,
            untangler,
            frame,
            copied,
            touched,
            cloth,
            session,
            correction,
            num_skipped_frames,
            last_frame,
        }
    }

    /// Takes over settings that were validated before.
    pub(crate) fn set_settings(&mut self, settings: Settings) {
        if let Err(error) = self.untangler.set_settings(settings) {
            tracing::error!(%error, "settings that were checked are refused");
        }
    }

    /// Answers the newest state, if one has come. `record` gets the header of the correction before it is sent. Returns
    /// that header.
    pub(crate) fn serve(
        &mut self,
        states: &StatePort,
        record: impl FnOnce(&CorrectionHeader),
    ) -> Option<CorrectionHeader> {
        let mut clock = StageClock::start(self.untangler.settings().deadline_us.map(Duration::from_micros));
        let (state, read) = states.read_newest(&mut self.frame, &self.cloth, &mut self.copied)?;
        let span = tracing::debug_span!("frame", session = self.session, frame = state.frame);
        let _entered = span.enter();
        let header = self.answer(&state, read, &mut clock, record);
        log_frame(self.session, &header);
        Some(header)
    }

    fn answer(
        &mut self,
        state: &StateHeader,
        read: Result<(), StateFault>,
        clock: &mut StageClock,
        record: impl FnOnce(&CorrectionHeader),
    ) -> CorrectionHeader {
        self.count_skipped(state.frame);
        let Self { ports, late_view, untangler, frame, touched, cloth, correction: kind, .. } = self;
        let Ports { corrections: port, paths, views, repairs } = ports;
        let checked = read.and_then(|()| ingest::check_header(state, cloth.num_vertices()));
        let settings = untangler.settings().clone();
        let limits = FrameLimits {
            max_face_pairs: settings.max_face_pairs(cloth.mesh().num_faces()),
            deadline_us: settings.deadline_us,
        };
        let outcome = checked.and_then(|()| process_guarded(untangler, frame, clock).ok_or(PANICKED));
        let outcome = outcome.and_then(|outcome| limits.check(outcome));
        clock.begin_index(stage::PUBLISH);
        let mut values = None;
        let mut header = match &outcome {
            Ok(outcome) => {
                let corrections = outcome.corrections;
                let touched = Touched::of(cloth, corrections, touched);
                let values = values.insert(Values { cloth, corrections, touched, kind: *kind, dt_s: state.dt_s });
                publish::header(state, outcome, values)
            }
            Err(fault) => publish::refused(state, *kind, *fault),
        };
        header.num_vertices = u32::try_from(cloth.num_vertices()).unwrap_or(u32::MAX);
        header.num_skipped_frames = self.num_skipped_frames;
        let repairs = repairs.as_ref().filter(|repairs| repairs.desk.is_wanted(&settings, state, &mut header));
        // Before the correction, so that a host that has the correction finds its paths.
        if let Ok(outcome) = &outcome {
            paths.publish(state.frame, &outcome.analysis.paths);
        }
        if let Err(error) = port.send(&mut header, clock, record, values.as_ref()) {
            log_lost(self.session, &error);
        }
        // After the correction, so that observers cost no latency.
        let (seen, found) = (checked.is_ok().then_some(&*frame), outcome.as_ref().ok().zip(values.as_ref()));
        let is_published = views.publish(&View { correction: &header, cloth, frame: seen, found });
        let waiting = LateView { header, has_positions: seen.is_some(), has_outcome: found.is_some() };
        *late_view = (!is_published).then_some(waiting);
        let is_broken = matches!(outcome, Err(StateFault { status: Status::Internal, .. }));
        // After the correction, which waits for no repair.
        if let Some(repairs) = repairs {
            repairs.ask(&settings, state, &header, frame);
        }
        if is_broken {
            self.reset();
        }
        header
    }

    /// Publishes the view of the last frame, where it had to wait and no other frame has come.
    pub(crate) fn publish_late_view(&mut self) {
        let Self { ports, late_view, untangler, frame, touched, cloth, correction: kind, .. } = self;
        let Some(LateView { header, has_positions, has_outcome }) = late_view.take() else { return };
        let outcome = has_outcome.then(|| untangler.last());
        let values = outcome.as_ref().map(|outcome| {
            let corrections = outcome.corrections;
            let touched = Touched::of(cloth, corrections, touched);
            Values { cloth, corrections, touched, kind: *kind, dt_s: header.dt_s }
        });
        let (frame, found) = (has_positions.then_some(&*frame), outcome.as_ref().zip(values.as_ref()));
        ports.views.publish_late(&View { correction: &header, cloth, frame, found });
    }

    fn count_skipped(&mut self, frame: u64) {
        if let Some(last) = self.last_frame.replace(frame) {
            let skipped = frame.saturating_sub(last).saturating_sub(1);
            self.num_skipped_frames = self.num_skipped_frames.saturating_add(skipped);
        }
    }

    /// Replaces the untangler after a panic, which may have left its memory inconsistent. Its settings are valid still.
    fn reset(&mut self) {
        if let Ok(mut fresh) = Untangler::new(Arc::clone(self.cloth.mesh()), self.untangler.settings().clone()) {
            fresh.set_labelled(self.untangler.is_labelled());
            fresh.set_single_precision(self.untangler.is_single_precision());
            fresh.set_displaced(self.untangler.is_displaced());
            self.untangler = fresh;
        }
    }
}

/// A frame whose view has to wait: its header, and what the memory of the work holds of it.
#[derive(Clone, Copy, Debug)]
struct LateView {
    header: CorrectionHeader,
    has_positions: bool,
    has_outcome: bool,
}

/// The ports that the work of a session sends to.
#[derive(Debug)]
pub(crate) struct Ports {
    pub(crate) corrections: CorrectionPort,
    pub(crate) paths: PathsPort,
    pub(crate) views: ViewPort,
    pub(crate) repairs: Option<SessionRepairs>,
}

/// Where the repairs of a session are asked for, and who works on them.
#[derive(Debug)]
pub(crate) struct SessionRepairs {
    pub(crate) desk: Arc<RepairDesk>,
    pub(crate) workers: Arc<RepairWorkers>,
}

impl SessionRepairs {
    fn ask(&self, settings: &Settings, state: &StateHeader, header: &CorrectionHeader, frame: &Frame) {
        if let Some(job) = self.desk.ask(settings, state, header, frame) {
            self.workers.push(job);
        }
    }
}

/// What may end a frame before its intersections are found.
#[derive(Clone, Copy, Debug)]
struct FrameLimits {
    max_face_pairs: u64,
    deadline_us: Option<u64>,
}

impl FrameLimits {
    /// The outcome, if everything that intersects was found.
    #[expect(clippy::cast_precision_loss, reason = "only for messages")]
    fn check(self, outcome: Outcome<'_>) -> Result<Outcome<'_>, StateFault> {
        let ended = |status, limit: u64| Err(StateFault { status, index: NO_FAULT, value: limit as f64 });
        match outcome.search {
            SearchEnd::Complete => Ok(outcome),
            SearchEnd::TooManyPairs => ended(Status::TooManyIntersections, self.max_face_pairs),
            SearchEnd::OutOfTime => ended(Status::OutOfTime, self.deadline_us.unwrap_or_default()),
        }
    }
}

/// Processes a frame; nothing if that panicked. A defect that one mesh brings out must not end the sessions of other
/// hosts.
fn process_guarded<'a>(untangler: &'a mut Untangler, frame: &'a Frame, clock: &mut StageClock) -> Option<Outcome<'a>> {
    catch_unwind(AssertUnwindSafe(|| {
        // Moved, so that the outcome may outlive the closure.
        let untangler = untangler;
        untangler.process(frame, clock)
    }))
    .ok()
}

fn log_lost(session: u64, error: &ServeError) {
    static LOST: Throttle = Throttle::new();
    if let Some(num_suppressed) = LOST.admit() {
        tracing::warn!(%error, session, num_suppressed, "the correction is lost");
    }
}

fn log_frame(session: u64, header: &CorrectionHeader) {
    if header.flags & TRUNCATED != 0 && header.status != Status::Ok.code() {
        static ENDED: Throttle = Throttle::new();
        if let Some(num_suppressed) = ENDED.admit() {
            let (frame, limit) = (header.frame, header.fault_value);
            if header.status == Status::OutOfTime.code() {
                let message = "frame not analysed: time was up before its intersections were found (deadline_us)";
                tracing::warn!(session, frame, limit, num_suppressed, "{message}");
            } else {
                let message = "frame not analysed: too many faces intersect (max_face_pairs, max_tested_pairs)";
                tracing::warn!(session, frame, limit, num_suppressed, "{message}");
            }
        }
    } else if header.status != Status::Ok.code() {
        static REFUSED: Throttle = Throttle::new();
        if let Some(num_suppressed) = REFUSED.admit() {
            let why = Status::from_code(header.status).map_or("unknown", Status::words);
            // Left out where no vertex is at fault.
            let vertex = Some(header.fault_index).filter(|&index| index != NO_FAULT);
            let (frame, value) = (header.frame, header.fault_value);
            tracing::info!(session, frame, why, vertex, value, num_suppressed, "frame refused");
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
