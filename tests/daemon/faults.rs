//! The fault table's rows, each shorter than `cargo run --release --example soak` makes it, but with real processes that are really killed.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shared with a program for developers, whose numbers are small"
)]

#[path = "../examples/soak/faults.rs"]
mod faults;
#[path = "../examples/soak/full_memory.rs"]
mod full_memory;
#[path = "../examples/soak/hostile.rs"]
mod hostile;
#[path = "../examples/soak/processes.rs"]
mod processes;
#[path = "../examples/soak/scene.rs"]
mod scene;

use std::{process::Command, time::Duration};

use faults::Row;
use processes::{Programs, this_program};

const SEED: u64 = 20;
const PROGRAMS: Programs = Programs { daemon, client };
const DOMAIN_VARIABLE: &str = "FAULTS_TEST_DOMAIN";
const ROLE_VARIABLE: &str = "FAULTS_TEST_ROLE";

fn daemon(domain: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_untangled"));
    command.args(["serve", "--domain", domain]).args(arguments);
    command
}

/// With fewer open files than 32 sessions take, which it may raise, as users' shells have them.
fn daemon_with_few_files(domain: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", r#"ulimit -S -n 256 && exec "$0" "$@""#, env!("CARGO_BIN_EXE_untangled")]);
    command.args(["serve", "--domain", domain]).args(arguments);
    command
}

fn client(domain: &str, role: &str) -> Command {
    let mut command = Command::new(this_program());
    command.args(["--exact", "client_process", "--ignored", "--nocapture"]);
    command.env(DOMAIN_VARIABLE, domain).env(ROLE_VARIABLE, role);
    command
}

/// The clients that the other tests kill; by itself it is no test.
#[test]
#[ignore = "run as a process of its own by the other tests"]
fn client_process() {
    match (std::env::var(DOMAIN_VARIABLE), std::env::var(ROLE_VARIABLE)) {
        (Ok(_), Ok(role)) if role == "full-memory" => full_memory::inner(PROGRAMS),
        (Ok(domain), Ok(role)) => processes::client_main(&domain, &role),
        _ => {}
    }
}

fn assert_clean(row: &Row) {
    assert!(row.is_clean() && row.num_tries > 0, "{row:?}");
    println!("{row:?}");
}

#[test]
fn two_hundred_killed_clients() {
    assert_clean(&faults::client_kills(PROGRAMS, 200, SEED));
}

#[test]
fn killed_daemons() {
    assert_clean(&faults::daemon_kills(PROGRAMS, 40, SEED));
}

#[test]
fn everybody_killed() {
    assert_clean(&faults::all_killed(PROGRAMS, 10, SEED));
}

#[test]
fn stopped_clients() {
    assert_clean(&faults::stopped_clients(PROGRAMS, 20, SEED));
}

#[test]
fn thirty_two_sessions() {
    assert_clean(&faults::many_sessions(
        Programs { daemon: daemon_with_few_files, ..PROGRAMS },
        32,
        Duration::from_secs(5),
    ));
}

#[test]
fn sessions_opened_and_closed() {
    assert_clean(&faults::open_and_close(PROGRAMS, 200));
}

#[test]
fn too_little_shared_memory() {
    match full_memory::full_memory(client("-", "full-memory")) {
        Some(row) => assert_clean(&row),
        None => println!("skipped: this user can't mount a small /dev/shm"),
    }
}

#[test]
fn samples_written_to_after_they_were_sent() {
    assert_clean(&hostile::writing_after_sending(PROGRAMS, 200, SEED));
}

#[test]
fn headers_that_lie() {
    assert_clean(&hostile::lying_headers(PROGRAMS, 1000, SEED));
}

#[test]
fn fields_at_their_limits() {
    assert_clean(&hostile::request_limits(PROGRAMS));
}
