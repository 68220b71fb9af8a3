//! What a daemon says about how it is going: schema `untangled.status/1`.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use serde::Serialize;
use untangled_proto::{
    CorrectionHeader, CorrectionKind, ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, Precision, Status,
    correction::stage,
};

use super::{ServeOptions, session::Session};

/// Counts of a session.
#[derive(Clone, Debug, Default)]
pub(super) struct Statistics {
    pub(super) num_frames: u64,
    num_refused_frames: u64,
    num_skipped_frames: u64,
    last: Option<CorrectionHeader>,
    last_at: Option<Instant>,
    mean_interval_s: Option<f64>,
}

impl Statistics {
    /// Notes that a frame has come; returns how many were overtaken so far.
    pub(super) fn skip_to(&mut self, frame: u64) -> u64 {
        if let Some(last) = &self.last {
            let skipped = frame.saturating_sub(last.frame).saturating_sub(1);
            self.num_skipped_frames = self.num_skipped_frames.saturating_add(skipped);
        }
        self.num_skipped_frames
    }

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
    uptime_s: f64,
    num_frames: u64,
    sessions: Vec<SessionReport>,
}

#[derive(Debug, Serialize)]
struct SessionReport {
    session: u64,
    num_vertices: usize,
    num_faces: usize,
    precision: Precision,
    correction: CorrectionKind,
    num_frames: u64,
    num_refused_frames: u64,
    num_skipped_frames: u64,
    rate_hz: f64,
    last_frame: Option<u64>,
    num_edge_face_intersections: u64,
    contour_length_m: f64,
    /// Times of the last frame in microseconds.
    stage_us: BTreeMap<&'static str, f64>,
}

/// The report of a daemon.
pub(super) fn report(options: &ServeOptions, uptime: Duration, sessions: &[Session]) -> Report {
    let sessions: Vec<SessionReport> = sessions.iter().map(session_report).collect();
    Report {
        schema: "untangled.status/1",
        domain: options.domain.name().to_owned(),
        pid: std::process::id(),
        library_version: LIBRARY_VERSION,
        protocol_version: PROTOCOL_VERSION,
        iceoryx2_version: ICEORYX2_VERSION,
        uptime_s: uptime.as_secs_f64(),
        num_frames: sessions.iter().map(|session| session.num_frames).sum(),
        sessions,
    }
}

fn session_report(session: &Session) -> SessionReport {
    let statistics = session.statistics();
    let last = statistics.last.unwrap_or_default();
    #[expect(clippy::cast_precision_loss, reason = "times of a frame are far below 2^53 ns")]
    let stage_us = stage::NAMES.iter().zip(last.stage_ns).map(|(&name, ns)| (name, ns as f64 / 1e3)).collect();
    SessionReport {
        session: session.id(),
        num_vertices: session.mesh().num_vertices(),
        num_faces: session.mesh().num_faces(),
        precision: session.precision(),
        correction: session.correction(),
        num_frames: statistics.num_frames,
        num_refused_frames: statistics.num_refused_frames,
        num_skipped_frames: statistics.num_skipped_frames,
        rate_hz: statistics.rate_hz(),
        last_frame: statistics.last.map(|header| header.frame),
        num_edge_face_intersections: last.num_edge_face_intersections,
        contour_length_m: last.contour_length_m,
        stage_us,
    }
}
