//! Round trips of all clients beside each other. It measures, so it is no test:
//!
//! ```sh
//! cargo test --release --test round_trips -- --ignored --nocapture
//! ```
#![cfg(feature = "daemon")]
#![allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "a measurement")]

#[path = "support/daemon.rs"]
mod daemon;
#[path = "support/frames.rs"]
mod frames;
#[path = "support/hosts.rs"]
mod hosts;
#[path = "support/python.rs"]
mod python;

use std::process::Command;

use daemon::{Daemon, TestDomain, fill_flat, sheet};
use frames::Frames;
use hosts::{has, libraries, root, run, scratch};
use untangled_client::Registration;

/// Runs of each client; they take turns, so that what else the machine does hits all of them.
const ROUNDS: usize = 3;
/// Frames of a run.
const REPEATS: usize = 100;

#[test]
#[ignore = "a measurement"]
fn table() {
    // A flat sheet of 16,129 vertices: nothing to untangle, so that the way there and back is what is measured.
    let registration: Registration = sheet(126);
    let mut state = vec![[0.0; 3]; registration.num_vertices];
    fill_flat(&mut state);
    let scene = Frames { registration, states: vec![state] };
    let folder = scratch("round-trips");
    scene.write(&folder.join("scene"));
    let mut programs = vec![("Rust", None)];
    for (name, compiler, standard, source) in
        [("C", "gcc", "-std=gnu11", "frames.c"), ("C++", "g++", "-std=c++17", "frames.cpp")]
    {
        if has(compiler, "its round trip") {
            let program = folder.join(source.replace('.', "_"));
            let mut compile = Command::new(compiler);
            compile
                .args(["-O2", standard, "-o"])
                .arg(&program)
                .arg(root().join("clients/c/tests/programs").join(source));
            compile.arg("-I").arg(root().join("clients/c")).arg("-L").arg(libraries()).arg("-luntangled_client");
            run(compile.arg(format!("-Wl,-rpath,{}", libraries().display())));
            programs.push((name, Some((program, None))));
        }
    }
    if let Some(command) = python::command("its round trip") {
        programs.push((
            "Python",
            Some((command.get_program().into(), Some(root().join("clients/python/tests/frames.py")))),
        ));
    }
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut medians = vec![Vec::new(); programs.len()];
    for _ in 0..ROUNDS {
        for ((_, program), medians) in programs.iter().zip(&mut medians) {
            medians.push(match program {
                None => scene.round_trip_us(&client, REPEATS),
                Some((program, script)) => {
                    let mut command = match script {
                        None => Command::new(program),
                        Some(script) => {
                            let mut python = python::command("").unwrap();
                            python.arg(script);
                            python
                        }
                    };
                    command.arg(domain.name()).arg(folder.join("scene")).arg(folder.join("out"));
                    let output = run(command.arg(REPEATS.to_string()));
                    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
                }
            });
        }
    }
    let num_vertices = scene.registration.num_vertices;
    println!(
        "Round trip of {num_vertices} vertices, median of {ROUNDS} runs of {REPEATS} frames, from before writing to having the correction\n"
    );
    println!("| client | microseconds | ratio to Rust |\n|---|---|---|");
    let middle = |medians: &mut Vec<f64>| {
        medians.sort_unstable_by(f64::total_cmp);
        medians[medians.len() / 2]
    };
    let rust = middle(&mut medians[0]);
    for ((name, _), medians) in programs.iter().zip(&mut medians) {
        let median = middle(medians);
        println!("| {name} | {median:.0} | {:.2} |", median / rust);
    }
}
