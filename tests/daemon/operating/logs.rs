//! Logs that nobody reads, and signals.

use std::{
    io::{BufRead, BufReader},
    process::{Child, Command, ExitStatus, Stdio},
};

use rustix::process::Signal;
use serde_json::Value;
use untangled_testkit::process::{PATIENCE, STEP, TestDomain, eventually, fill_flat, send_signal, serve, sheet};

/// A daemon, killed when it is dropped.
struct Served(Child);

impl Served {
    fn start(mut command: Command) -> (Self, BufReader<std::process::ChildStderr>) {
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("ready") {
            line.clear();
            assert!(lines.read_line(&mut line).unwrap() > 0, "the daemon did not start");
        }
        (Self(child), lines)
    }

    fn stop(mut self, signal: Signal) -> ExitStatus {
        send_signal(&self.0, signal);
        self.0.wait().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Every frame writes a line.
fn talkative(domain: &TestDomain) -> Command {
    let mut command = serve(domain);
    command.args(["--log", "debug"]);
    command
}

fn exchange(domain: &TestDomain, num_frames: usize) {
    let mut session = domain.connect().register(sheet(2)).unwrap();
    for _ in 0..num_frames {
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    }
}

#[test]
fn daemon_whose_standard_error_is_closed_serves_and_ends_in_order() {
    let domain = TestDomain::new();
    let (daemon, log) = Served::start(talkative(&domain));
    drop(log);
    exchange(&domain, 50);
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn daemon_whose_log_nobody_reads_serves_and_ends_in_order() {
    let domain = TestDomain::new();
    let (daemon, log) = Served::start(talkative(&domain));
    // More lines than a pipe and the queue of lines hold.
    exchange(&domain, 5000);
    assert!(daemon.stop(Signal::TERM).success());
    drop(log);
    domain.assert_nothing_left();
}

#[test]
fn daemon_ends_in_order_when_its_terminal_is_closed() {
    let domain = TestDomain::new();
    let program = serve(&domain);
    // These tests may run under `nohup` themselves, and what is ignored is inherited.
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP").arg(program.get_program()).args(program.get_args());
    let (daemon, _log) = Served::start(command);
    exchange(&domain, 1);
    assert_eq!(daemon.stop(Signal::HUP).code(), Some(0));
    domain.assert_nothing_left();
    assert!(!domain.0.lock_path().exists(), "the lock's file does not stay");
}

#[test]
fn daemon_under_nohup_outlives_its_terminal() {
    let domain = TestDomain::new();
    let program = serve(&domain);
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' HUP; exec \"$0\" \"$@\""]).arg(program.get_program()).args(program.get_args());
    let (daemon, _log) = Served::start(command);
    send_signal(&daemon.0, Signal::HUP);
    exchange(&domain, 1);
    assert!(daemon.stop(Signal::TERM).success());
}

#[test]
fn log_in_json_is_json_from_ready_to_the_end() {
    let domain = TestDomain::new();
    let mut command = serve(&domain);
    let mut child = command.env("UNTANGLED_TELEMETRY__FORMAT", "json").stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let message = |line: &String| {
        let value: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
        assert!(value["timestamp"].is_string() && value["level"].is_string() && value["target"].is_string(), "{line}");
        value["fields"]["message"].as_str().unwrap_or_default().to_owned()
    };
    let mut said = Vec::new();
    while said.last().is_none_or(|last| last != "ready") {
        said.push(message(&lines.next().expect("it says that it is ready")));
    }
    send_signal(&child, Signal::TERM);
    said.extend(lines.map(|line| message(&line)));
    assert!(child.wait().unwrap().success());
    assert_eq!(said.last().unwrap(), "ended");
}

#[test]
fn variable_that_is_no_key_is_a_warning_and_a_wrong_value_an_error() {
    let domain = TestDomain::new();
    let mut command = serve(&domain);
    command.env("UNTANGLED_SETTING__PATH_RINGS", "3").env("UNTANGLED_PREFIX", "/opt");
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let said: Vec<String> = lines.take_while(|line| line != "ready").collect();
    let daemon = Served(child);
    eventually("the daemon serves", || domain.0.is_announced());
    assert!(daemon.stop(Signal::TERM).success());
    let warning = |name: &str| said.iter().find(|line| line.contains("WARN") && line.contains(name)).unwrap();
    assert!(warning("UNTANGLED_SETTING__PATH_RINGS").contains("did you mean UNTANGLED_SETTINGS__PATH_RINGS?"));
    assert!(warning("UNTANGLED_PREFIX").contains("has no effect"));
    let wrong = serve(&domain).env("UNTANGLED_SETTINGS__PATH_RINGS", "many").output().unwrap();
    let words = String::from_utf8(wrong.stderr).unwrap();
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        words.contains("UNTANGLED_SETTINGS__PATH_RINGS: settings.path_rings: ") && words.contains("many"),
        "{words}"
    );
    assert!(!words.contains("usize") && !words.contains("u32"), "{words}");
}
