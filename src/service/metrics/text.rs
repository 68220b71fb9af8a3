//! The report of the daemon in the text format of Prometheus, version 0.0.4.
//!
//! Series with a session end with it. Those of the daemon count all sessions and never fall.

use std::fmt::Write as _;

use crate::service::requests::status::{Report, SessionReport};

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

/// The report in the text format of Prometheus, version 0.0.4.
#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
pub(super) fn prometheus(report: &Report) -> String {
    let mut out = String::new();
    let mut family = |name: &str, kind: &str, help: &str, samples: &mut dyn FnMut(&mut String, &str)| {
        let name = format!("untangled_{name}");
        // Writing to a string does not fail.
        let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}");
        samples(&mut out, &name);
    };
    for (name, kind, help, value) in [
        ("uptime_seconds", "gauge", "Time since the daemon started.", report.uptime_s),
        ("workers", "gauge", "Threads that work on frames.", report.num_workers as f64),
        ("sessions", "gauge", "Sessions that are open.", report.sessions.len() as f64),
        ("sessions_registered_total", "counter", "Sessions that were registered.", report.num_registered as f64),
        ("requests_refused_total", "counter", "Requests that were refused.", report.num_refused_requests as f64),
    ] {
        family(name, kind, help, &mut |out, name| {
            let _ = writeln!(out, "{name} {value}");
        });
    }
    for (name, help, value) in [
        ("frames_total", "Frames of all sessions, those of sessions that have ended included.", report.num_frames),
        ("frames_refused_total", "Frames of all sessions that could not be used.", report.num_refused_frames),
        ("frames_skipped_total", "Frames of all sessions that were overtaken.", report.num_skipped_frames),
        (
            "frames_truncated_total",
            "Frames of all sessions that a limit ended, of time or of intersections.",
            report.num_truncated_frames,
        ),
    ] {
        family(&format!("daemon_{name}"), "counter", help, &mut |out, name| {
            let _ = writeln!(out, "{name} {value}");
        });
    }
    family("daemon_stage_seconds_total", "counter", "Time spent in each stage, all sessions.", &mut |out, name| {
        for (stage, seconds) in &report.stage_total_s {
            let _ = writeln!(out, "{name}{{stage=\"{stage}\"}} {seconds}");
        }
    });
    for (name, kind, help, value) in BY_SESSION {
        family(name, kind, help, &mut |out, name| {
            for session in &report.sessions {
                let _ = writeln!(out, "{name}{{session=\"{}\"}} {}", session.session, value(session));
            }
        });
    }
    family("stage_seconds_total", "counter", "Time spent in each stage of all frames.", &mut |out, name| {
        for session in &report.sessions {
            for (stage, seconds) in &session.stage_total_s {
                let _ = writeln!(out, "{name}{{session=\"{}\",stage=\"{stage}\"}} {seconds}", session.session);
            }
        }
    });
    out
}
