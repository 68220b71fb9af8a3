//! What a daemon says about how it is going: schema `untangled.status/1`.

use std::{collections::BTreeMap, sync::Arc, time::Instant};

use serde::Serialize;
use untangled_proto::{CorrectionHeader, CorrectionKind, ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, Precision, Status, correction::{TRUNCATED, stage}};

use super::{registry::Registry, session::Session};

/// Counts of a session.
#[derive(Clone, Debug, Default)]
pub(super) struct Statistics {
    pub(super) num_frames: u64,
    num_refused_frames: u64,
    num_truncated_frames: u64,
    /// Times of all frames together, by stage, in nanoseconds.
    stage_ns: [u64; 8],
    last: Option<CorrectionHeader>,
    last_at: Option<Instant>,
    mean_interval_s: Option<f64>,
}

impl Statistics {
    /// Notes what became of a frame.
    pub(super) fn record(&mut self, header: &CorrectionHeader) {
        const WEIGHT: f64 = 0.1;
        let now = Instant::now();
        if let Some(last_at) = self.last_at.replace(now) {
            let interval_s = now.duration_since(last_at).as_secs_f64();
            let mean_s = self.mean_interval_s.get_or_insert(interval_s);
            *mean_s += WEIGHT * (interval_s - *mean_s);
        }
        self.num_frames += 1;
        self.num_refused_frames += u64::from(header.status != Status::Ok.code());
        self.num_truncated_frames += u64::from(header.flags & TRUNCATED != 0);
        for (sum, ns) in self.stage_ns.iter_mut().zip(header.stage_ns) {
            *sum = sum.saturating_add(ns);
        }
        self.last = Some(*header);
    }

    /// Frames per second, lately; it falls while nothing comes.
    fn rate_hz(&self) -> f64 {
        match (self.mean_interval_s, self.last_at) {
            (Some(mean_s), Some(last_at)) => 1.0 / mean_s.max(last_at.elapsed().as_secs_f64()).max(1e-9),
            _ => 0.0,
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Report {
    schema: &'static str,
    domain: String,
    pid: u32,
    library_version: &'static str,
    protocol_version: u32,
    iceoryx2_version: &'static str,
    pub(super) uptime_s: f64,
    pub(super) num_workers: usize,
    /// Requests that were refused since the daemon started.
    pub(super) num_refused_requests: u64,
    /// Sessions that were registered since the daemon started.
    pub(super) num_registered: u64,
    num_frames: u64,
    pub(super) sessions: Vec<SessionReport>,
}

#[derive(Debug, Serialize)]
pub(super) struct SessionReport {
    pub(super) session: u64,
    pub(super) num_vertices: usize,
    pub(super) num_faces: usize,
    precision: Precision,
    correction: CorrectionKind,
    pub(super) num_frames: u64,
    pub(super) num_refused_frames: u64,
    pub(super) num_skipped_frames: u64,
    pub(super) num_truncated_frames: u64,
    pub(super) rate_hz: f64,
    last_frame: Option<u64>,
    pub(super) num_edge_face_intersections: u64,
    pub(super) contour_length_m: f64,
    /// Times of the last frame in microseconds.
    stage_us: BTreeMap<&'static str, f64>,
    /// Times of all frames together in seconds.
    pub(super) stage_total_s: BTreeMap<&'static str, f64>,
}

/// The report of a daemon.
pub(super) fn report(registry: &Registry) -> Report {
    let sessions: Vec<SessionReport> = registry.sessions().iter().map(session_report).collect();
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
        num_frames: sessions.iter().map(|session| session.num_frames).sum(),
        sessions,
    }
}

fn session_report(session: &Arc<Session>) -> SessionReport {
    let statistics = session.statistics();
    let last = statistics.last.unwrap_or_default();
    let by_stage = |scale: f64, times: [u64; 8]| {
        #[expect(clippy::cast_precision_loss, reason = "2^53 ns are a hundred days of work")]
        let scaled = times.map(|ns| ns as f64 / scale);
        stage::NAMES.into_iter().zip(scaled).collect()
    };
    SessionReport {
        session: session.id(),
        num_vertices: session.mesh().num_vertices(),
        num_faces: session.mesh().num_faces(),
        precision: session.precision(),
        correction: session.correction(),
        num_frames: statistics.num_frames,
        num_refused_frames: statistics.num_refused_frames,
        num_skipped_frames: last.num_skipped_frames,
        num_truncated_frames: statistics.num_truncated_frames,
        rate_hz: statistics.rate_hz(),
        last_frame: statistics.last.map(|header| header.frame),
        num_edge_face_intersections: last.num_edge_face_intersections,
        contour_length_m: last.contour_length_m,
        stage_us: by_stage(1e3, last.stage_ns),
        stage_total_s: by_stage(1e9, statistics.stage_ns),
    }
}
