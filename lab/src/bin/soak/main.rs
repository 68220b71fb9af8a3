//! Makes the fault table: what was tried how often, and what was lost.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin soak -- [--out docs/results/faults.md] [--scale 0.01] [--seed N] [ROW]...
//! ```
//!
//! Daemons and clients are processes of this program, on domains of their own; nothing else is touched. Without rows it
//! makes all of them, at full length some half an hour. `--scale` shortens.

#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a program for developers, whose numbers are small"
)]

mod allocations;
mod cost;
mod frames;
mod plan;
mod programs;
mod repairs;
mod round_trips;
mod rows;

use std::{fmt::Write, time::Instant};

use plan::Plan;
use programs::{PROGRAMS, echo};
use rows::{ROWS, make_row};
use untangled_lab::daemon::serve;
use untangled_testkit::{
    faults::{Row, full_memory_main},
    process::client_main,
};

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;

const HEAD: &str = "\
# Faults, and what they cost

Made by `cargo run --release -p untangled-lab --bin soak -- --out docs/results/faults.md` on Linux with two cores. \
Every answer that a living client gets is compared, bit by bit, with what the library says for the frame that it names.

| fault | tried | frames compared | wrong | lost | |
|---|---|---|---|---|---|
";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["daemon", domain] => serve(domain),
        ["client", domain, "huge"] => cost::huge_main(domain),
        ["client", domain, role] => client_main(domain, role),
        ["echo", path, num_vertices] => round_trips::echo_main(path, num_vertices.parse().expect("a number")),
        ["full-memory"] => full_memory_main(PROGRAMS),
        _ => make_tables(&Plan::parse(&words)),
    }
}

/// Makes the rows and sections that are wanted, and writes them to a file if there is to be one.
fn make_tables(plan: &Plan) {
    let mut text = HEAD.to_owned();
    let mut clean = true;
    for name in ROWS.into_iter().filter(|name| plan.wants(name)) {
        let begin = Instant::now();
        let Some(row) = make_row(name, plan) else {
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
    let sections: [Section; 5] = [
        ("round-trip", "Round trip", || round_trips::round_trips(PROGRAMS, echo)),
        ("allocations", "Allocations for each frame after warm-up", cost::allocations_per_frame),
        ("fairness", "Fairness", || vec![cost::fairness(PROGRAMS)]),
        ("repairs", "Repairs beside frames", || repairs::beside_frames(PROGRAMS)),
        ("idle", "An idle daemon", || vec![cost::idle(PROGRAMS)]),
    ];
    for (_, title, make) in sections.into_iter().filter(|(name, ..)| plan.wants(name)) {
        let section = format!("\n## {title}\n\n{}\n", make().join("\n"));
        println!("{section}");
        text.push_str(&section);
    }
    if let Some(out) = &plan.out {
        std::fs::write(out, untangled_lab::table::wrapped(&text)).expect("the file can be written");
    }
    assert!(clean, "something was lost: see above");
}
