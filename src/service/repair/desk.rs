//! The repairs of one session: the request that waits, and the job that answers it.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
    time::{Duration, Instant},
};

use untangle::{
    frame::Frame,
    intersect::SearchLimits,
    settings::{Repair, Settings},
};
use untangled_proto::{
    CorrectionHeader, Precision, RepairHeader, StateHeader, Status,
    correction::{self, NO_FAULT},
    repair::{CERTIFIED, TRUNCATED},
    state::REPAIR,
};
use untangled_transport::throttle::Throttle;

use super::{
    port::RepairPort,
    progress::Progress,
    requests::{Counts, Request, State, Totals},
    solve::{Task, solve},
};
use crate::service::{pool::Job, session::Cloth};

/// The repairs of one session. What is in work ends when the last strong reference, which the session has, is gone.
#[derive(Debug)]
pub(crate) struct RepairDesk {
    session: u64,
    cloth: Arc<Cloth>,
    precision: Precision,
    port: RepairPort,
    state: Mutex<State>,
    /// Those of all sessions.
    totals: Arc<Totals>,
}

/// Answers the requests of one session, one after the other.
#[derive(Debug)]
pub(crate) struct RepairJob(Weak<RepairDesk>);

impl RepairDesk {
    pub(crate) fn new(
        session: u64,
        cloth: Arc<Cloth>,
        precision: Precision,
        port: RepairPort,
        totals: Arc<Totals>,
    ) -> Self {
        Self { session, cloth, precision, port, state: Mutex::default(), totals }
    }

    /// Whether a frame is to be repaired: where its state asks for it, or the settings do. Fills in what its correction
    /// says of that.
    pub(crate) fn is_wanted(&self, settings: &Settings, state: &StateHeader, header: &mut CorrectionHeader) -> bool {
        let is_asked = state.flags & REPAIR != 0;
        let is_analysed = header.status == Status::Ok.code();
        let num_edge_face = header.num_edge_face_intersections;
        let is_wanted = is_asked
            | match settings.repair {
                Repair::Asked => false,
                Repair::Auto if !is_analysed => {
                    header.progress = state.progress;
                    false
                }
                Repair::Auto => {
                    let mut progress = Progress::from_bits(state.progress);
                    let is_busy = is_asked || self.is_busy();
                    let is_due = progress.is_repair_due(num_edge_face, header.contour_length_m, is_busy);
                    header.progress = progress.to_bits();
                    is_due
                }
                Repair::Always => num_edge_face > 0 && !self.is_busy(),
            };
        if is_wanted && is_repairable(header.status) {
            header.flags |= correction::REPAIRING;
        }
        is_wanted
    }

    /// Has a frame repaired, which replaces one that waits; gives back the job to queue, if none is. `header` is that
    /// of its correction: a frame that can't be used is answered at once.
    pub(crate) fn ask(
        self: &Arc<Self>,
        settings: &Settings,
        state: &StateHeader,
        header: &CorrectionHeader,
        frame: &Frame,
    ) -> Option<RepairJob> {
        if !is_repairable(header.status) {
            self.send(&mut refused(header), &[]);
            return None;
        }
        let time_us = Some(state.repair_deadline_us).filter(|&time| time > 0 && state.flags & REPAIR != 0);
        let request = Request {
            frame: state.frame,
            simulated_s: state.simulated_s,
            positions: frame.positions().iter().map(|point| (*point).into()).collect(),
            limits: SearchLimits::new(settings, self.cloth.mesh().num_faces()),
            time: time_us.or(settings.repair_deadline_us).map(Duration::from_micros),
            asked: Instant::now(),
        };
        let mut state = self.state();
        let replaced = state.waiting.replace(request);
        if replaced.is_some() {
            state.counts.num_replaced += 1;
            self.totals.add_replaced();
        }
        let has_job = std::mem::replace(&mut state.has_job, true);
        drop(state);
        (!has_job).then(|| RepairJob(Arc::downgrade(self)))
    }

    /// Whether a repair is in work, or about to be.
    fn is_busy(&self) -> bool {
        self.state().is_busy()
    }

    pub(crate) fn counts(&self) -> Counts {
        self.state().counts
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it is held.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send(&self, header: &mut RepairHeader, displacements: &[[f64; 3]]) {
        header.num_vertices = u32::try_from(self.cloth.num_vertices()).unwrap_or(u32::MAX);
        {
            // Before it is sent, so that a host that has the repair finds it counted.
            let counts = &mut self.state().counts;
            counts.num_sent += 1;
            let is_certified = header.flags & CERTIFIED != 0;
            counts.num_certified += u64::from(is_certified);
            self.totals.add_sent(is_certified);
            header.num_replaced = counts.num_replaced;
        }
        if let Err(error) = self.port.send(header, displacements) {
            static LOST: Throttle = Throttle::new();
            if let Some(num_suppressed) = LOST.admit() {
                tracing::warn!(%error, session = self.session, num_suppressed, "the repair is lost");
            }
        }
        tracing::debug!(
            session = self.session,
            frame = header.frame,
            status = header.status,
            certified = header.flags & CERTIFIED != 0,
            truncated = header.flags & TRUNCATED != 0,
            num_edge_face_intersections = header.num_edge_face_intersections,
            num_iterations = header.num_iterations,
            waited_ns = header.waited_ns,
            repair_ns = header.repair_ns,
            "repaired"
        );
    }
}

impl Job for RepairJob {
    /// A repair may take minutes.
    fn is_large(&self) -> bool {
        true
    }

    fn run(self) -> Option<Self> {
        let Self(desk) = &self;
        let (request, cloth, precision, session) = {
            let desk = desk.upgrade()?;
            let request = desk.state().begin();
            (request, Arc::clone(&desk.cloth), desk.precision, desk.session)
        };
        if let Some(request) = request {
            let (mut header, displacements) = answer(&request, &cloth, precision, session, desk);
            let desk = desk.upgrade()?;
            desk.state().is_working = false;
            desk.send(&mut header, &displacements);
        }
        let goes_on = desk.upgrade()?.state().goes_on();
        goes_on.then_some(self)
    }
}

/// Whether a frame whose correction has this status may be repaired: the time of a frame may not suffice for what that
/// of a repair does.
fn is_repairable(status: u32) -> bool {
    [Status::Ok.code(), Status::OutOfTime.code()].contains(&status)
}

/// The answer to a request for a frame that can't be used: what its correction says.
fn refused(header: &CorrectionHeader) -> RepairHeader {
    RepairHeader {
        frame: header.frame,
        simulated_s: header.simulated_s,
        status: header.status,
        flags: if header.flags & correction::TRUNCATED != 0 { TRUNCATED } else { 0 },
        fault_index: header.fault_index,
        fault_value: header.fault_value,
        ..RepairHeader::default()
    }
}

/// Works on a request until its time is up or the session has ended.
fn answer(
    request: &Request,
    cloth: &Cloth,
    precision: Precision,
    session: u64,
    desk: &Weak<RepairDesk>,
) -> (RepairHeader, Vec<[f64; 3]>) {
    let span = tracing::debug_span!("repair", session, frame = request.frame);
    let _entered = span.enter();
    let begin = Instant::now();
    let deadline = request.time.and_then(|time| request.asked.checked_add(time));
    let should_stop = || desk.strong_count() == 0 || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let task = Task { mesh: cloth.mesh(), positions: &request.positions, precision, limits: request.limits };
    let (mut header, displacements) = guarded(|| solve(&task, &should_stop));
    let displacements = for_host(cloth, &mut header, displacements);
    if header.status == Status::OutOfTime.code() {
        #[expect(clippy::cast_precision_loss, reason = "only for messages")]
        let limit_us = request.time.map_or(0, |time| time.as_micros()) as f64;
        header.fault_value = limit_us;
    }
    (header.frame, header.simulated_s) = (request.frame, request.simulated_s);
    header.waited_ns = nanoseconds(begin.saturating_duration_since(request.asked));
    header.repair_ns = nanoseconds(begin.elapsed());
    (header, displacements)
}

/// The displacements of the host's vertices, of which the header counts those that move: what is one in the mesh moves
/// as one.
fn for_host(cloth: &Cloth, header: &mut RepairHeader, displacements: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    if cloth.weld().is_none() || displacements.is_empty() {
        return displacements;
    }
    let displacement = |vertex| displacements[cloth.mesh_vertex(vertex).index()];
    let of_host: Vec<[f64; 3]> = (0..cloth.num_vertices()).map(displacement).collect();
    let lengths = of_host.iter().map(|step| step.iter().map(|value| value * value).sum::<f64>().sqrt());
    let moved: Vec<f64> = lengths.filter(|&length| length > 0.0).collect();
    header.num_moved = u32::try_from(moved.len()).unwrap_or(u32::MAX);
    header.mean_displacement_m = moved.iter().sum::<f64>() / f64::from(header.num_moved.max(1));
    of_host
}

/// A defect that one frame brings out costs this repair only.
fn guarded(work: impl FnOnce() -> (RepairHeader, Vec<[f64; 3]>)) -> (RepairHeader, Vec<[f64; 3]>) {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        let status = Status::Internal.code();
        (RepairHeader { status, fault_index: NO_FAULT, ..RepairHeader::default() }, Vec::new())
    })
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guarded_answers_a_panic_with_status_internal() {
        let (header, displacements) = guarded(|| panic!("on purpose"));
        assert_eq!((header.status, header.fault_index), (Status::Internal.code(), NO_FAULT));
        assert!(displacements.is_empty() && header.flags == 0);
    }
}
