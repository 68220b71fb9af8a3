//! Makes the fault table: what was tried how often, and what was lost.
//!
//! ```sh
//! cargo run --release --example soak -- [--out docs/FAULTS.md] [--scale 0.01] [--seed N] [ROW]...
//! ```
//!
//! Daemons and clients are processes of this program, on domains of their own; nothing else is touched. Without rows it makes all of them,
//! at full length some half an hour. `--scale` shortens.

#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::unwrap_used,
    unreachable_pub,
    missing_debug_implementations,
    reason = "a program for developers, whose numbers are small; what goes wrong ends it with words"
)]

mod allocations;
mod cost;
mod faults;
mod full_memory;
mod fuzz;
mod hostile;
mod processes;
mod scene;

use std::{
    fmt::Write,
    process::Command,
    time::{Duration, Instant},
};

use faults::Row;
use fuzz::Target;
use processes::{Programs, this_program};
use untangled::service::{self, ServeOptions, Shutdown};
use untangled_transport::Domain;

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

const PROGRAMS: Programs = Programs { daemon, client };

fn daemon(domain: &str, _: &[&str]) -> Command {
    this("daemon", &[domain])
}

fn client(domain: &str, role: &str) -> Command {
    this("client", &[domain, role])
}

fn echo(path: &str, num_vertices: usize) -> Command {
    this("echo", &[path, &num_vertices.to_string()])
}

fn this(role: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(this_program());
    command.arg(role).args(arguments);
    command
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["daemon", domain] => {
            let domain = Domain::locate(Some(domain)).expect("the parent chose it");
            service::run(&ServeOptions::new(domain), &Shutdown::default(), || eprintln!("ready")).expect("it serves");
        }
        ["client", domain, "huge"] => cost::huge_main(domain),
        ["client", domain, role] => processes::client_main(domain, role),
        ["echo", path, num_vertices] => cost::echo_main(path, num_vertices.parse().expect("a number")),
        ["full-memory"] => full_memory::inner(PROGRAMS),
        _ => command(&words),
    }
}

/// What to do, and how much of it.
struct Plan {
    scale: f64,
    seed: u64,
    rows: Vec<String>,
}

impl Plan {
    fn wants(&self, row: &str) -> bool {
        self.rows.is_empty() || self.rows.iter().any(|wanted| wanted == row)
    }

    fn count(&self, full: u64) -> u64 {
        ((full as f64 * self.scale) as u64).max(3)
    }
}

fn command(words: &[&str]) {
    let (mut plan, mut out) = (Plan { scale: 1.0, seed: 1, rows: Vec::new() }, None);
    let mut words = words.iter();
    while let Some(&word) = words.next() {
        match word {
            "--out" => out = words.next().map(|file| (*file).to_owned()),
            "--scale" => plan.scale = words.next().and_then(|text| text.parse().ok()).expect("--scale needs a number"),
            "--seed" => plan.seed = words.next().and_then(|text| text.parse().ok()).expect("--seed needs a number"),
            row => plan.rows.push(row.to_owned()),
        }
    }
    let mut text = String::from(
        "# Faults, and what they cost\n\n\
         Made by `cargo run --release --example soak -- --out docs/FAULTS.md` on Linux with two cores. Every answer that a living client gets is compared, \
         bit by bit, with what the library says for the frame that it names.\n\n\
         | fault | tried | frames compared | wrong | lost | |\n|---|---|---|---|---|---|\n",
    );
    let mut clean = true;
    for (name, make) in ROWS {
        if !plan.wants(name) {
            continue;
        }
        let begin = Instant::now();
        let Some(row) = make(&plan) else {
            println!("{name}: can't be tried here");
            continue;
        };
        clean &= row.is_clean();
        let Row { what, num_tries, num_frames, num_wrong, num_lost, note } = row;
        let line = format!("| {what} | {num_tries} | {num_frames} | {num_wrong} | {num_lost} | {note} |");
        println!("{line}  ({name}, {:.1} s)", begin.elapsed().as_secs_f64());
        let _ = writeln!(text, "{line}");
    }
    type Section = (&'static str, &'static str, fn() -> Vec<String>);
    let sections: [Section; 4] = [
        ("round-trip", "Round trip", || cost::round_trips(PROGRAMS, echo)),
        ("allocations", "Allocations for each frame after warm-up", cost::allocations_per_frame),
        ("fairness", "Fairness", || vec![cost::fairness(PROGRAMS)]),
        ("idle", "An idle daemon", || vec![cost::idle(PROGRAMS)]),
    ];
    for (name, title, make) in sections {
        if plan.wants(name) {
            let section = format!("\n## {title}\n\n{}\n", make().join("\n"));
            println!("{section}");
            text.push_str(&section);
        }
    }
    if let Some(out) = out {
        std::fs::write(&out, text).expect("the file can be written");
    }
    assert!(clean, "something was lost: see above");
}

type Make = fn(&Plan) -> Option<Row>;

const ROWS: [(&str, Make); 14] = [
    ("client-kills", |plan| Some(faults::client_kills(PROGRAMS, plan.count(1000), plan.seed))),
    ("daemon-kills", |plan| Some(faults::daemon_kills(PROGRAMS, plan.count(200), plan.seed))),
    ("all-killed", |plan| Some(faults::all_killed(PROGRAMS, plan.count(100), plan.seed))),
    ("stopped", |plan| Some(faults::stopped_clients(PROGRAMS, plan.count(200), plan.seed))),
    ("open-close", |plan| Some(faults::open_and_close(PROGRAMS, plan.count(1000)))),
    ("full-memory", |_| full_memory::full_memory(this("full-memory", &[]))),
    ("after-sending", |plan| Some(hostile::writing_after_sending(PROGRAMS, plan.count(2000), plan.seed))),
    ("lying-headers", |plan| Some(hostile::lying_headers(PROGRAMS, plan.count(20_000), plan.seed))),
    ("request-limits", |_| Some(hostile::request_limits(PROGRAMS))),
    ("fuzz-ingest", |plan| Some(fuzzed(plan, Target::Ingest))),
    ("fuzz-register", |plan| Some(fuzzed(plan, Target::Register))),
    ("fuzz-settings", |plan| Some(fuzzed(plan, Target::Settings))),
    ("fuzz-mesh-file", |plan| Some(fuzzed(plan, Target::MeshFile))),
    ("many-sessions", |plan| {
        let time = Duration::from_secs_f64((600.0 * plan.scale).max(2.0));
        Some(faults::many_sessions(PROGRAMS, 32, time))
    }),
];

/// A million inputs over all targets.
fn fuzzed(plan: &Plan, target: Target) -> Row {
    let num_tries = plan.count(match target {
        Target::Ingest => 150_000,
        Target::Register | Target::MeshFile => 225_000,
        Target::Settings => 400_000,
    });
    let what = format!("fuzzed input: {target:?}");
    match fuzz::run(target, plan.seed, 0, num_tries) {
        Ok(accepted) => Row {
            what,
            num_tries,
            note: format!("{accepted} accepted and held the invariants, the others refused in words"),
            ..Row::default()
        },
        Err(find) => Row { what, num_tries, num_wrong: 1, note: find, ..Row::default() },
    }
}
