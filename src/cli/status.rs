//! `untangled status`.

use std::{
    io::IsTerminal,
    time::{Duration, Instant},
};

use clap::Args;
use serde_json::Value;
use untangled_client::{Client, ClientOptions};

use super::outcome::{self, CliError, Outcome};

#[derive(Debug, Args)]
pub(super) struct StatusArgs {
    /// Which daemon; the default is $UNTANGLED_DOMAIN, else `default`.
    #[arg(long, value_name = "NAME")]
    domain: Option<String>,
    /// Print one JSON document, schema `untangled.status/1`.
    #[arg(long)]
    json: bool,
    /// Go on, once every so many seconds, until the daemon or the reader is gone; with `--json` one document a line.
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, default_missing_value = "1")]
    watch: Option<f64>,
}

pub(super) fn run(args: &StatusArgs) -> Result<Outcome, CliError> {
    let client = Client::connect(ClientOptions { domain: args.domain.clone(), timeout: Duration::from_secs(2) })?;
    let Some(seconds) = args.watch else {
        let report = client.status()?;
        let text = if args.json { serde_json::to_string_pretty(&report)? } else { table(&report) };
        outcome::print(&(text + "\n"))?;
        return Ok(Outcome::Clean);
    };
    let pause = Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|pause| *pause >= SHORTEST_PAUSE)
        .ok_or_else(|| format!("--watch {seconds}: at least {} seconds", SHORTEST_PAUSE.as_secs_f64()))?;
    let clear = if !args.json && std::io::stdout().is_terminal() { CLEAR } else { "" };
    let mut next = Instant::now();
    loop {
        let report = client.status()?;
        let text = if args.json { report.to_string() } else { table(&report) };
        if !outcome::print(&format!("{clear}{text}\n"))? {
            return Ok(Outcome::Clean);
        }
        next += pause;
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
    }
}

/// Shortest period of `--watch`.
const SHORTEST_PAUSE: Duration = Duration::from_millis(100);
/// Moves the cursor home and clears the screen.
const CLEAR: &str = "\x1b[H\x1b[2J";

/// Heads of the table's columns.
const HEADS: [&str; 11] =
    ["session", "vertices", "faces", "frames", "skipped", "refused", "truncated", "repairs", "Hz", "EFs", "ms/frame"];

/// The report for people: a line about the daemon, then one for each session.
fn table(report: &Value) -> String {
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    let mut out = format!(
        "untangled {} on domain `{}`, process {}, up {:.0} s, {} frames",
        report["library_version"].as_str().unwrap_or("?"),
        report["domain"].as_str().unwrap_or("?"),
        report["pid"],
        number(&report["uptime_s"]),
        report["num_frames"],
    );
    let sessions = report["sessions"].as_array().map_or(&[][..], Vec::as_slice);
    if sessions.is_empty() {
        return out + "\nno sessions";
    }
    let rows = sessions.iter().map(|session| {
        let count = |name: &str| session[name].to_string();
        [
            count("session"),
            count("num_vertices"),
            count("num_faces"),
            count("num_frames"),
            count("num_skipped_frames"),
            count("num_refused_frames"),
            count("num_truncated_frames"),
            repairs(&session["repairs"]),
            format!("{:.1}", number(&session["rate_hz"])),
            count("num_edge_face_intersections"),
            format!("{:.3}", number(&session["stage_us"]["total"]) / 1e3),
        ]
    });
    let rows: Vec<[String; 11]> = [HEADS.map(str::to_owned)].into_iter().chain(rows).collect();
    // Each column is as wide as its longest entry.
    let widths: [usize; 11] = std::array::from_fn(|k| rows.iter().map(|row| row[k].len()).max().unwrap_or(0));
    for row in rows {
        out.push('\n');
        let cells: Vec<String> = row.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        out.push_str(&cells.join("  "));
    }
    for line in sessions.iter().filter_map(watched) {
        out.push('\n');
        out.push_str(&line);
    }
    out
}

/// Who watches a session, if somebody does.
fn watched(session: &Value) -> Option<String> {
    let observers = session["observers"].as_array()?.iter();
    let named = observers.map(|observer| match observer["name"].as_str().unwrap_or_default() {
        "" => format!("process {}", observer["pid"]),
        name => format!("{name} (process {})", observer["pid"]),
    });
    let named = named.collect::<Vec<_>>();
    (!named.is_empty()).then(|| format!("session {} is watched by {}", session["session"], named.join(", ")))
}

/// Certified repairs of those that were sent; a dash for a session without repairs.
fn repairs(counts: &Value) -> String {
    if counts.is_null() { "-".into() } else { format!("{}/{}", counts["num_certified"], counts["num_sent"]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_of_large_numbers_keeps_columns_under_their_heads() {
        let session = |number: u64| {
            serde_json::json!({
                "session": number, "num_vertices": number, "num_faces": number, "num_frames": number,
                "num_skipped_frames": number, "num_refused_frames": number, "num_truncated_frames": number,
                "repairs": (number > 7).then(|| serde_json::json!({ "num_sent": number, "num_certified": 3 })),
                "rate_hz": 1.0 * number as f64, "num_edge_face_intersections": number,
                "stage_us": { "total": 10.0 * number as f64 },
            })
        };
        let report = serde_json::json!({ "sessions": [session(7), session(12_345_678_901)], "num_frames": 3 });
        let text = table(&report);
        let lines: Vec<&str> = text.lines().skip(1).collect();
        // Columns end below the ends of their heads.
        let ends = |line: &str| -> Vec<usize> {
            let bytes = line.as_bytes();
            (0..bytes.len())
                .filter(|&k| bytes[k] != b' ' && bytes.get(k + 1).is_none_or(|next| *next == b' '))
                .collect()
        };
        assert_eq!(ends(lines[0]).len(), HEADS.len());
        for line in &lines {
            assert_eq!(ends(line), ends(lines[0]), "{text}");
        }
    }
}
