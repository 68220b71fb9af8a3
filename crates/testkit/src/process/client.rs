//! A client as a process that can be killed.

use std::{
    collections::VecDeque,
    io::{BufRead, BufReader, Read},
    process::{Child, ChildStdout, Stdio},
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::{Client, ClientOptions, RegisterError, RequestError, Session, Status};

use super::{
    KnownCloth, PATIENCE, Programs, STEP, TestDomain,
    observer::{observer_main, say},
    send_signal,
};

/// A client process that says on standard output how far it is. Dropping it kills it.
#[derive(Debug)]
pub struct ClientProcess {
    child: Child,
    output: BufReader<ChildStdout>,
}

impl ClientProcess {
    /// Starts a client in a role of [`client_main`].
    pub fn start(programs: Programs, domain: &TestDomain, role: &str) -> Self {
        let mut command = (programs.client)(domain.name(), role);
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the client's program is there");
        let output = BufReader::new(child.stdout.take().expect("it is a pipe"));
        Self { child, output }
    }

    /// Sends it a signal.
    pub fn signal(&self, signal: Signal) {
        send_signal(&self.child, signal);
    }

    /// Waits until it has said something.
    pub fn wait_for(&mut self, what: &str) {
        let said = self.output.by_ref().lines().map_while(Result::ok).any(|line| line.contains(what));
        assert!(said, "the client ended before it said `{what}`");
    }

    /// Kills it; returns the last thing that it said.
    pub fn kill(mut self) -> String {
        self.signal(Signal::KILL);
        let last = self.output.by_ref().lines().map_while(Result::ok).filter(|line| line.starts_with("at ")).last();
        self.child.wait().expect("it was started here");
        last.unwrap_or_else(|| "at start".to_owned())
    }
}

impl Drop for ClientProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What a client process does, by its role: `frames` exchanges frames and keeps corrections, `loan` stops while it
/// holds a loan, `register` registers a large mesh over and over, `observe`
/// watches the first session, `observe1` the second.
pub fn client_main(domain: &str, role: &str) {
    if let Some(place) = role.strip_prefix("observe") {
        return observer_main(domain, place.parse().unwrap_or(0));
    }
    // Long enough to outlive a daemon that is restarted, and not much longer than the test that watches it.
    let options = ClientOptions { domain: Some(domain.to_owned()), timeout: PATIENCE };
    let client = match Client::connect(options) {
        Ok(client) => client,
        Err(error) => return eprintln!("a client that connected: {error}"),
    };
    say("connected");
    let cloth = KnownCloth::new(if role == "register" { 20_000 } else { 500 });
    loop {
        say("registering");
        let mut session = match client.register(cloth.registration()) {
            Ok(session) => session,
            // Sessions of killed clients count until they are cleaned up.
            Err(RegisterError::Request(RequestError::Refused { status: Status::TooManySessions, .. })) => {
                std::thread::sleep(Duration::from_millis(20));
                continue;
            }
            Err(error) => return eprintln!("a client that registered: {error}"),
        };
        say("registered");
        if role == "register" {
            continue;
        }
        exchange_frames(&cloth, &mut session, role == "loan");
    }
}

/// Exchanges frames without an end and keeps the last corrections; with `hold_loans`, stops with a loan after the first
/// frames.
fn exchange_frames(cloth: &KnownCloth, session: &mut Session, hold_loans: bool) {
    let mut held = VecDeque::new();
    loop {
        match cloth.exchange(session, Duration::from_millis(500)) {
            Ok(correction) if cloth.is_right(&correction) => held.push_back(correction),
            Ok(correction) => say(&format!("wrong frame {}", correction.frame())),
            // A daemon that went away comes back.
            Err(_) => {}
        }
        if held.len() > 2 {
            held.pop_front();
        }
        say("frame");
        if hold_loans && session.frame() > 3 {
            hold_loan(session);
        }
    }
}

fn hold_loan(session: &mut Session) {
    let _ = session.publish(STEP, |_| {
        say("loan");
        std::thread::sleep(PATIENCE);
    });
}
