//! The report of a running daemon: schema `untangled.status/1`.

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use serde::Serialize;
use untangle::weld::Weld;
use untangled_proto::{
    CorrectionKind, ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, Precision, correction::stage,
};
use untangled_transport::process_id::ProcessId;

use super::registry::Registry;
use crate::service::{
    repair::Counts,
    session::{Observer, Session},
};

/// The report of a daemon, as status replies and metrics carry it.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    schema: &'static str,
    domain: String,
    pid: u32,
    library_version: &'static str,
    protocol_version: u32,
    iceoryx2_version: &'static str,
    pub(crate) uptime_s: f64,
    pub(crate) num_workers: usize,
    /// Requests that were refused since the daemon started.
    pub(crate) num_refused_requests: u64,
    /// Sessions that were registered since the daemon started.
    pub(crate) num_registered: u64,
    /// Frames of all sessions since the daemon started, those of sessions that have ended included; so are the counts
    /// and times below.
    pub(crate) num_frames: u64,
    pub(crate) num_refused_frames: u64,
    pub(crate) num_skipped_frames: u64,
    pub(crate) num_truncated_frames: u64,
    /// Repairs of all sessions.
    pub(crate) repairs: Counts,
    pub(crate) stage_total_s: BTreeMap<&'static str, f64>,
    pub(crate) sessions: Vec<SessionReport>,
}

/// The part of a report that is about one session.
#[derive(Debug, Serialize)]
pub(crate) struct SessionReport {
    pub(crate) session: u64,
    /// The process that registered it.
    #[serde(skip_serializing_if = "Option::is_none")]
    host: Option<ProcessReport>,
    /// Who watches it, one entry for each observer.
    pub(crate) observers: Vec<ProcessReport>,
    pub(crate) num_vertices: usize,
    pub(crate) num_faces: usize,
    /// Vertices that became one with an earlier one in their place; only for sessions that asked for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    num_welded_vertices: Option<usize>,
    precision: Precision,
    correction: CorrectionKind,
    pub(crate) num_frames: u64,
    pub(crate) num_refused_frames: u64,
    pub(crate) num_skipped_frames: u64,
    pub(crate) num_truncated_frames: u64,
    /// Repairs that were sent, those of them that are certified, and requests that a newer one replaced while they
    /// waited; only for sessions that asked for repairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) repairs: Option<Counts>,
    pub(crate) rate_hz: f64,
    last_frame: Option<u64>,
    pub(crate) num_edge_face_intersections: u64,
    pub(crate) contour_length_m: f64,
    /// Times of the last frame in microseconds.
    stage_us: BTreeMap<&'static str, f64>,
    /// Times of all frames together in seconds.
    pub(crate) stage_total_s: BTreeMap<&'static str, f64>,
}

/// A process that takes part in a session.
#[derive(Debug, Serialize)]
pub(crate) struct ProcessReport {
    pid: u32,
    /// The name of its program, or what it calls itself; empty where nobody knows.
    name: String,
}

/// Collects the report of a daemon.
pub(crate) fn report(registry: &Registry) -> Report {
    let sessions: Vec<SessionReport> = registry.sessions().iter().map(session_report).collect();
    let totals = registry.totals();
    let count = |count: &AtomicU64| count.load(Ordering::Relaxed);
    Report {
        schema: "untangled.status/1",
        domain: registry.options().domain.name().to_owned(),
        pid: std::process::id(),
        library_version: LIBRARY_VERSION,
        protocol_version: PROTOCOL_VERSION,
        iceoryx2_version: ICEORYX2_VERSION,
        uptime_s: registry.uptime().as_secs_f64(),
        num_workers: registry.options().num_workers(),
        num_refused_requests: registry.num_refused_requests(),
        num_registered: registry.num_registered(),
        num_frames: count(&totals.num_frames),
        num_refused_frames: count(&totals.num_refused_frames),
        num_skipped_frames: count(&totals.num_skipped_frames),
        num_truncated_frames: count(&totals.num_truncated_frames),
        repairs: registry.repairs(),
        stage_total_s: by_stage(1e9, std::array::from_fn(|k| count(&totals.stage_ns[k]))),
        sessions,
    }
}

fn session_report(session: &Arc<Session>) -> SessionReport {
    let statistics = session.statistics();
    let last = statistics.last.unwrap_or_default();
    SessionReport {
        session: session.id(),
        host: session.client().map(|process| process_report(process, process.name().unwrap_or_default())),
        observers: session
            .observers()
            .into_iter()
            .map(|Observer { process, name }| process_report(process, name))
            .collect(),
        num_vertices: session.cloth().num_vertices(),
        num_faces: session.cloth().mesh().num_faces(),
        num_welded_vertices: session.cloth().weld().map(Weld::num_merged),
        precision: session.precision(),
        correction: session.correction(),
        num_frames: statistics.num_frames,
        num_refused_frames: statistics.num_refused_frames,
        num_skipped_frames: last.num_skipped_frames,
        num_truncated_frames: statistics.num_truncated_frames,
        repairs: session.repairs(),
        rate_hz: statistics.rate_hz(),
        last_frame: statistics.last.map(|header| header.frame),
        num_edge_face_intersections: last.num_edge_face_intersections,
        contour_length_m: last.contour_length_m,
        stage_us: by_stage(1e3, last.stage_ns),
        stage_total_s: by_stage(1e9, statistics.stage_ns),
    }
}

fn process_report(process: ProcessId, name: String) -> ProcessReport {
    ProcessReport { pid: process.number(), name }
}

/// Times of the stages by name, in nanoseconds divided by `scale`.
fn by_stage(scale: f64, times: [u64; 8]) -> BTreeMap<&'static str, f64> {
    #[expect(clippy::cast_precision_loss, reason = "2^53 ns are a hundred days of work")]
    let scaled = times.map(|ns| ns as f64 / scale);
    stage::NAMES.into_iter().zip(scaled).collect()
}
