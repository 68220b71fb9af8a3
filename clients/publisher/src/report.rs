//! The lines that a run prints, and its summary.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};
use untangled_client::{CorrectionHeader, CorrectionKind, pair_type};
use untangled_proto::correction::stage;

use crate::host::StepReport;

/// How a run ended. Written as JSON by `--summary`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// Whether the exact check found the last states free of intersections.
    pub clean: bool,
    /// Number of steps simulated.
    pub num_frames: usize,
    /// Edge-face hits of the first state, by the exact check.
    pub num_edge_face_before: usize,
    /// Edge-face hits of the last state, by the exact check.
    pub num_edge_face_after: usize,
    /// Intersecting pairs of triangles of the first state.
    pub num_face_pairs_before: usize,
    /// Intersecting pairs of triangles of the last state.
    pub num_face_pairs_after: usize,
    /// Frames for which no correction came in time.
    pub num_late_frames: usize,
    /// Frames that the daemon repaired.
    #[serde(default)]
    pub num_repaired_frames: usize,
}

/// Writes the line of one frame.
///
/// # Errors
/// What the writer says.
pub fn write_line(out: &mut dyn Write, frame: usize, report: &StepReport, kind: CorrectionKind) -> io::Result<()> {
    let round_trip_ms = report.round_trip.as_secs_f64() * 1e3;
    let Some(header) = &report.header else {
        return writeln!(out, "frame {frame:>5}  no correction within {round_trip_ms:.1} ms");
    };
    write!(
        out,
        "frame {frame:>5}  {:>5} edge-face  {:<34}  path {:>7.3} m  inside {:>4}  masked {:>4}  largest {:>9.3e} {}",
        header.num_edge_face_intersections,
        types(header),
        // An empty sum may be -0, whose sign is not printed.
        header.contour_length_m.max(0.0).abs(),
        header.num_inside,
        report.num_masked,
        report.largest_value,
        unit(kind),
    )?;
    write!(out, "  round trip {round_trip_ms:>6.2} ms (")?;
    let mut separator = "";
    for (name, nanoseconds) in stage::NAMES.iter().zip(header.stage_ns).take(stage::TOTAL) {
        #[expect(clippy::cast_precision_loss, reason = "printed with two decimals")]
        let milliseconds = nanoseconds as f64 / 1e6;
        write!(out, "{separator}{name} {milliseconds:.2}")?;
        separator = ", ";
    }
    writeln!(out, "){}", if report.repaired.is_some() { "  repaired" } else { "" })
}

/// Writes the header of the lines of [`write_brief_line`].
///
/// # Errors
/// What the writer says.
pub fn write_brief_header(out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "frame  intersections  answer in  intersection paths by type")
}

/// Writes a short line of one frame, with the number of edge-face hits that the exact check found.
///
/// # Errors
/// What the writer says.
pub fn write_brief_line(out: &mut dyn Write, frame: usize, num_hits: usize, report: &StepReport) -> io::Result<()> {
    let round_trip_ms = report.round_trip.as_secs_f64() * 1e3;
    let found = report.header.as_ref().map_or_else(|| "no answer in time".to_owned(), types);
    let repaired = if report.repaired.is_some() { ", repaired" } else { "" };
    writeln!(out, "{frame:>5}  {num_hits:>13}  {round_trip_ms:>6.2} ms  {found}{repaired}")
}

/// Path pairs by type, as in `2 LL, 1 BLI`.
fn types(header: &CorrectionHeader) -> String {
    let found: Vec<String> = pair_type::NAMES
        .iter()
        .zip(header.num_pairs)
        .filter(|&(_, count)| count > 0)
        .map(|(name, count)| format!("{count} {name}"))
        .collect();
    if found.is_empty() { "no path".into() } else { found.join(", ") }
}

fn unit(kind: CorrectionKind) -> &'static str {
    match kind {
        CorrectionKind::Force => "N",
        CorrectionKind::Acceleration => "m/s^2",
        CorrectionKind::VelocityChange => "m/s",
        CorrectionKind::Displacement => "m",
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn write_line_names_types_counts_and_units() {
        let mut header = CorrectionHeader { num_edge_face_intersections: 42, ..CorrectionHeader::default() };
        header.num_pairs[pair_type::LOOP_LOOP] = 2;
        header.num_pairs[pair_type::BI_BI] = 1;
        let report = StepReport {
            header: Some(header),
            largest_value: 0.5,
            num_masked: 7,
            round_trip: Duration::from_micros(1500),
            repaired: Some(true),
        };
        let mut line = Vec::new();
        write_line(&mut line, 3, &report, CorrectionKind::Force).unwrap();
        let line = String::from_utf8(line).unwrap();
        for part in ["frame     3", "42 edge-face", "2 LL, 1 BI/BI", "5.000e-1 N", "1.50 ms", "repaired"] {
            assert!(line.contains(part), "`{part}` is not in `{line}`");
        }
    }
}
