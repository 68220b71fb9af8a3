//! Rows of the fault table with processes that are really killed, each shorter than the laboratory's `soak` makes it.

use std::{process::Command, time::Duration};

use untangled_testkit::{
    faults::{self, Row},
    process::{Programs, client_main, this_test, untangled},
};

use crate::machine::busy;

const SEED: u64 = 20;
pub(crate) const PROGRAMS: Programs = Programs { daemon, client };
const DOMAIN_VARIABLE: &str = "FAULTS_TEST_DOMAIN";
const ROLE_VARIABLE: &str = "FAULTS_TEST_ROLE";

fn daemon(domain: &str) -> Command {
    let mut command = Command::new(untangled());
    command.args(["serve", "--domain", domain]);
    command
}

/// With fewer open files than 32 sessions take, which it may raise, as users' shells have them.
fn daemon_with_few_files(domain: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", r#"ulimit -S -n 256 && exec "$0" "$@""#]).arg(untangled());
    command.args(["serve", "--domain", domain]);
    command
}

fn client(domain: &str, role: &str) -> Command {
    let mut command = this_test(module_path!(), "client_process");
    command.env(DOMAIN_VARIABLE, domain).env(ROLE_VARIABLE, role);
    command
}

/// The clients that other tests kill, in processes of their own. Does nothing where it is run as a test.
#[test]
#[ignore = "run as a process of its own by other tests"]
fn client_process() {
    match (std::env::var(DOMAIN_VARIABLE), std::env::var(ROLE_VARIABLE)) {
        (Ok(_), Ok(role)) if role == "full-memory" => faults::full_memory_main(PROGRAMS),
        (Ok(domain), Ok(role)) => client_main(&domain, &role),
        _ => {}
    }
}

fn assert_clean(row: &Row) {
    assert!(row.is_clean() && row.num_tries > 0, "{row:?}");
    // Shown with `--nocapture`: what was tried and seen.
    eprintln!("{row:?}");
}

#[test]
fn clients_killed_at_any_moment_cost_others_nothing() {
    let _guard = busy();
    assert_clean(&faults::client_kills(PROGRAMS, 200, SEED));
}

#[test]
fn daemons_killed_at_any_moment_cost_clients_no_answer() {
    let _guard = busy();
    assert_clean(&faults::daemon_kills(PROGRAMS, 40, SEED));
}

#[test]
fn daemon_after_killed_daemon_and_clients_serves_and_leaves_nothing() {
    let _guard = busy();
    assert_clean(&faults::all_killed(PROGRAMS, 10, SEED));
}

#[test]
fn stopped_clients_cost_others_nothing() {
    let _guard = busy();
    assert_clean(&faults::stopped_clients(PROGRAMS, 20, SEED));
}

#[test]
fn thirty_two_sessions_with_few_descriptors_are_served() {
    let _guard = busy();
    assert_clean(&faults::many_sessions(
        Programs { daemon: daemon_with_few_files, ..PROGRAMS },
        32,
        Duration::from_secs(5),
    ));
}

#[test]
fn sessions_opened_and_closed_leave_nothing() {
    let _guard = busy();
    assert_clean(&faults::open_and_close(PROGRAMS, 200));
}

#[test]
fn registration_without_shared_memory_is_refused_and_sessions_continue() {
    let _guard = busy();
    match faults::full_memory(client("-", "full-memory")) {
        Some(row) => assert_clean(&row),
        None => println!("skipped: this user can't mount a small /dev/shm"),
    }
}

#[test]
fn samples_written_to_after_sending_get_finite_answers() {
    let _guard = busy();
    assert_clean(&faults::writing_after_sending(PROGRAMS, 200, SEED));
}

#[test]
fn frames_with_lying_headers_are_refused_or_right() {
    let _guard = busy();
    assert_clean(&faults::lying_headers(PROGRAMS, 1000, SEED));
}

#[test]
fn repair_requests_with_lying_headers_are_refused_or_right() {
    let _guard = busy();
    assert_clean(&faults::lying_repair_requests(PROGRAMS, 1000, SEED));
}

#[test]
fn requests_with_fields_at_their_limits_get_one_reply() {
    let _guard = busy();
    assert_clean(&faults::request_limits(PROGRAMS));
}
