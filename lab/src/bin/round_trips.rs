//! Round trips of the clients of all languages beside each other.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin round_trips
//! ```
//!
//! C, C++ and Python take part where gcc, g++ and Python are. The daemon is a process of this program.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "prints a table; what goes wrong ends it")]

use std::{path::Path, process::Command};

use rustix::process::Signal;
use untangled_client::Registration;
use untangled_lab::{
    daemon::{daemon, serve},
    table::{print_header, print_text},
};
use untangled_testkit::{
    files::repository,
    hosts::{Frames, has, link, python, run, scratch},
    process::{Programs, TestDomain, fill_flat, sheet},
};

/// Runs of each client; they take turns, so that other load of the machine hits all of them.
const ROUNDS: usize = 3;
/// Frames of a run.
const REPEATS: usize = 100;

fn main() {
    if let [_, role, domain] = &std::env::args().collect::<Vec<_>>()[..]
        && role == "daemon"
    {
        return serve(domain);
    }
    // A flat sheet of 16,129 vertices: nothing to untangle, so that the round trip alone is measured.
    let registration: Registration = sheet(126);
    let mut state = vec![[0.0; 3]; registration.num_vertices];
    fill_flat(&mut state);
    let scene = Frames { registration, states: vec![state] };
    let folder = scratch("round-trips");
    scene.write(&folder.join("scene"));
    let programs = programs(&folder);
    let domain = TestDomain::new();
    let client_role = |_: &str, _: &str| unreachable!("no client is a process of this program");
    let daemon = Programs { daemon, client: client_role }.start_daemon(&domain);
    let client = domain.connect();
    let mut medians = vec![Vec::new(); programs.len()];
    for _ in 0..ROUNDS {
        for ((_, program), medians) in programs.iter().zip(&mut medians) {
            medians.push(match program {
                None => scene.round_trip_us(&client, REPEATS),
                Some(start) => round_trip_us(start(), domain.name(), &folder),
            });
        }
    }
    drop(client);
    assert!(daemon.stop(Signal::TERM).success());
    print(&scene, &programs, &mut medians);
}

/// A client: its language, and how to start it where it is not this program.
type Program = (&'static str, Option<Box<dyn Fn() -> Command>>);

/// The clients whose languages are on this machine; C and C++ are built in a folder.
fn programs(folder: &Path) -> Vec<Program> {
    let mut programs: Vec<Program> = vec![("Rust", None)];
    for (name, compiler, standard, source) in
        [("C", "gcc", "-std=gnu11", "frames.c"), ("C++", "g++", "-std=c++17", "frames.cpp")]
    {
        if has(compiler, "its round trip") {
            let program = folder.join(source.replace('.', "_"));
            let mut compile = Command::new(compiler);
            compile.args(["-O2", standard, "-o"]).arg(&program);
            run(link(compile.arg(repository().join("clients/c/tests/programs").join(source))));
            programs.push((name, Some(Box::new(move || Command::new(&program)))));
        }
    }
    if python::command("its round trip").is_some() {
        let start = || {
            let mut python = python::command("").unwrap();
            python.arg(repository().join("clients/python/tests/frames.py"));
            python
        };
        programs.push(("Python", Some(Box::new(start))));
    }
    programs
}

/// Median round trip of a client in another language, in microseconds.
fn round_trip_us(mut command: Command, domain: &str, folder: &Path) -> f64 {
    command.arg(domain).arg(folder.join("scene")).arg(folder.join("out"));
    let output = run(command.arg(REPEATS.to_string()));
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}

fn print(scene: &Frames, programs: &[Program], medians: &mut [Vec<f64>]) {
    print_text(&format!(
        "Round trip of {} vertices, median of {ROUNDS} runs of {REPEATS} frames, from before writing to having the \
         correction\n",
        scene.registration.num_vertices
    ));
    print_header(&["client", "microseconds", "ratio to Rust"]);
    let middle = |medians: &mut Vec<f64>| {
        medians.sort_unstable_by(f64::total_cmp);
        medians[medians.len() / 2]
    };
    let rust = middle(&mut medians[0]);
    for ((name, _), medians) in programs.iter().zip(medians) {
        let median = middle(medians);
        println!("| {name} | {median:.0} | {:.2} |", median / rust);
    }
}
