//! The report of the daemon in the text format of Prometheus, version 0.0.4.
//!
//! Series with a session end with it. Those of the daemon count all sessions and never fall.

use std::fmt::Write as _;

use crate::service::{
    repair::Counts,
    requests::status::{Report, SessionReport},
};

/// A number of a session.
type Value = fn(&SessionReport) -> f64;

#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
const BY_SESSION: &[(&str, &str, &str, Value)] = &[
    ("frames_total", "counter", "Frames that were answered.", |s| s.num_frames as f64),
    ("frames_refused_total", "counter", "Frames that could not be used.", |s| s.num_refused_frames as f64),
    ("frames_skipped_total", "counter", "Frames that were overtaken by newer ones.", |s| s.num_skipped_frames as f64),
    ("frames_truncated_total", "counter", "Frames that a limit ended, of time or of intersections.", |s| {
        s.num_truncated_frames as f64
    }),
    ("frame_rate_hz", "gauge", "Frames per second, lately.", |s| s.rate_hz),
    ("vertices", "gauge", "Vertices of the mesh.", |s| s.num_vertices as f64),
    ("faces", "gauge", "Faces of the mesh.", |s| s.num_faces as f64),
    ("edge_face_intersections", "gauge", "Edges that pierce a face, in the last frame.", |s| {
        s.num_edge_face_intersections as f64
    }),
    ("contour_length_metres", "gauge", "Length of all paths, in the last frame.", |s| s.contour_length_m),
];

/// A number of a session's repairs.
type RepairValue = fn(&Counts) -> u64;

/// Of sessions that asked for repairs.
const REPAIRS: [(&str, &str, RepairValue); 3] = [
    ("repairs_total", "Repairs that were sent.", |counts| counts.num_sent),
    ("repairs_certified_total", "Of these, certified: an exact check found them clean.", |counts| counts.num_certified),
    ("repairs_replaced_total", REPLACED, |counts| counts.num_replaced),
];
const REPLACED: &str = "Requests for repairs that a newer one replaced while they waited.";

/// The report as text.
#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
pub(super) fn prometheus(report: &Report) -> String {
    let mut out = String::new();
    for (name, kind, help, value) in [
        ("uptime_seconds", "gauge", "Time since the daemon started.", report.uptime_s),
        ("workers", "gauge", "Threads that work on frames.", report.num_workers as f64),
        ("sessions", "gauge", "Sessions that are open.", report.sessions.len() as f64),
        ("sessions_registered_total", "counter", "Sessions that were registered.", report.num_registered as f64),
        ("requests_refused_total", "counter", "Requests that were refused.", report.num_refused_requests as f64),
        ("daemon_frames_total", "counter", "Frames of all sessions, open or not.", report.num_frames as f64),
        ("daemon_frames_refused_total", "counter", "Of these, not usable.", report.num_refused_frames as f64),
        ("daemon_frames_skipped_total", "counter", "Frames overtaken by newer ones.", report.num_skipped_frames as f64),
        ("daemon_frames_truncated_total", "counter", "Of these, ended by a limit.", report.num_truncated_frames as f64),
        ("daemon_repairs_total", "counter", "Repairs of all sessions.", report.repairs.num_sent as f64),
        ("daemon_repairs_certified_total", "counter", "Of these, certified.", report.repairs.num_certified as f64),
        ("daemon_repairs_replaced_total", "counter", REPLACED, report.repairs.num_replaced as f64),
    ] {
        family(&mut out, name, kind, help, [(String::new(), value)]);
    }
    let by_stage = report.stage_total_s.iter().map(|(stage, seconds)| (format!("{{stage=\"{stage}\"}}"), *seconds));
    family(&mut out, "daemon_stage_seconds_total", "counter", "Time spent in each stage, all sessions.", by_stage);
    let label = |session: &SessionReport| format!("session=\"{}\"", session.session);
    for (name, kind, help, value) in BY_SESSION {
        let samples = report.sessions.iter().map(|session| (format!("{{{}}}", label(session)), value(session)));
        family(&mut out, name, kind, help, samples);
    }
    for (name, help, value) in REPAIRS {
        let counts = report.sessions.iter().filter_map(|session| Some((session, session.repairs.as_ref()?)));
        let samples = counts.map(|(session, counts)| (format!("{{{}}}", label(session)), value(counts) as f64));
        family(&mut out, name, "counter", help, samples);
    }
    let by_session = report.sessions.iter().flat_map(|session| {
        let stages = session.stage_total_s.iter();
        stages.map(move |(stage, seconds)| (format!("{{{},stage=\"{stage}\"}}", label(session)), *seconds))
    });
    family(&mut out, "stage_seconds_total", "counter", "Time spent in each stage of all frames.", by_session);
    out
}

/// A family of samples, each with its labels in braces.
fn family(out: &mut String, name: &str, kind: &str, help: &str, samples: impl IntoIterator<Item = (String, f64)>) {
    // Writing to a string does not fail.
    let _ = writeln!(out, "# HELP untangled_{name} {help}\n# TYPE untangled_{name} {kind}");
    for (labels, value) in samples {
        let _ = writeln!(out, "untangled_{name}{labels} {value}");
    }
}
