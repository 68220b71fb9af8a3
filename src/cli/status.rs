//! `untangled status`.

use std::{
    fmt::Write,
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
        let text = if args.json { serde_json::to_string_pretty(&report)? } else { table(&report)? };
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
        let text = if args.json { report.to_string() } else { table(&report)? };
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

fn table(report: &Value) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    writeln!(
        out,
        "untangled {} on domain `{}`, process {}, up {:.0} s, {} frames",
        report["library_version"].as_str().unwrap_or("?"),
        report["domain"].as_str().unwrap_or("?"),
        report["pid"],
        number(&report["uptime_s"]),
        report["num_frames"],
    )?;
    let sessions = report["sessions"].as_array().map_or(&[][..], Vec::as_slice);
    if sessions.is_empty() {
        write!(out, "no sessions")?;
        return Ok(out);
    }
    write!(
        out,
        "{:>7} {:>9} {:>9} {:>9} {:>8} {:>8} {:>9} {:>7} {:>8} {:>9}",
        "session", "vertices", "faces", "frames", "skipped", "refused", "truncated", "Hz", "EFs", "ms/frame"
    )?;
    for session in sessions {
        write!(
            out,
            "\n{:>7} {:>9} {:>9} {:>9} {:>8} {:>8} {:>9} {:>7.1} {:>8} {:>9.3}",
            session["session"],
            session["num_vertices"],
            session["num_faces"],
            session["num_frames"],
            session["num_skipped_frames"],
            session["num_refused_frames"],
            session["num_truncated_frames"],
            number(&session["rate_hz"]),
            session["num_edge_face_intersections"],
            number(&session["stage_us"]["total"]) / 1e3,
        )?;
    }
    Ok(out)
}
