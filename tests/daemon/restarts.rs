//! Peers that are killed or end, and those that go on without them.

use std::{
    io::{BufRead, BufReader},
    process::{Child, Stdio},
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::{Client, ClientOptions, ExchangeError, PublishError, Session, WaitError};
use untangled_testkit::process::{
    Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, send_signal, sheet, this_test,
};

/// Exchanges a frame, however often it takes, as a host would that goes on without its daemon.
fn exchange_again(session: &mut Session) {
    eventually("the session goes on", || match session.exchange(STEP, Duration::from_millis(200), fill_flat) {
        Ok(correction) => correction.frame() == session.frame(),
        Err(
            ExchangeError::Publish(PublishError::Reconnecting)
            | ExchangeError::Wait(WaitError::DaemonLost { .. } | WaitError::Timeout { .. }),
        ) => false,
        Err(error) => panic!("{error}"),
    });
}

#[test]
fn session_of_a_restarted_daemon_registers_again() {
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(8)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    for (signal, num_registrations) in [(Signal::KILL, 2), (Signal::TERM, 3), (Signal::KILL, 4)] {
        let frame = session.publish(STEP, fill_flat).unwrap();
        session.wait(frame, PATIENCE).unwrap();
        daemon.stop(signal);
        // Noticed before publishing or while waiting; either way the call ends, and so does each one after it.
        for _ in 0..3 {
            let error = session.exchange(STEP, Duration::from_millis(200), fill_flat).unwrap_err();
            assert!(
                matches!(
                    error,
                    ExchangeError::Publish(PublishError::Reconnecting)
                        | ExchangeError::Wait(WaitError::DaemonLost { .. })
                ),
                "{error}"
            );
        }
        daemon = Daemon::start(&domain);
        exchange_again(&mut session);
        assert_eq!(session.num_registrations(), num_registrations);
    }
    drop(session);
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn session_that_never_waits_continues_after_a_restart() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(8)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    daemon.stop(Signal::KILL);
    let _daemon = Daemon::start(&domain);
    let before = session.frame();
    eventually("a correction of a later frame", || {
        match session.publish(STEP, fill_flat) {
            Ok(_) | Err(PublishError::Reconnecting) => {}
            Err(error) => panic!("{error}"),
        }
        session.newest().unwrap().is_some_and(|correction| correction.frame() > before)
    });
    assert_eq!(session.num_registrations(), 2);
}

/// The client that other tests kill, in a process of its own. Does nothing where it is run as a test.
#[test]
#[ignore = "run as a process of its own by other tests"]
fn client_process() {
    let Ok(domain) = std::env::var("TEST_CLIENT_DOMAIN") else { return };
    let options = ClientOptions { domain: Some(domain), timeout: PATIENCE };
    let mut session = Client::connect(options).unwrap().register(sheet(30)).unwrap();
    let _held = session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    loop {
        println!("frame {}", session.exchange(STEP, PATIENCE, fill_flat).unwrap().frame());
    }
}

fn spawn_client(domain: &TestDomain) -> Child {
    let mut child = this_test(module_path!(), "client_process")
        .env("TEST_CLIENT_DOMAIN", domain.name())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains("frame 3")));
    std::thread::spawn(move || lines.for_each(drop));
    child
}

#[test]
fn session_and_memory_of_a_killed_client_are_removed() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut session = client.register(sheet(8)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    let num_sessions = || client.status().unwrap()["sessions"].as_array().unwrap().len();
    let steady = domain.shared_memory().len();
    for _ in 0..3 {
        let mut other = spawn_client(&domain);
        assert_eq!(num_sessions(), 2);
        send_signal(&other, Signal::KILL);
        other.wait().unwrap();
        eventually("its session is gone", || {
            session.exchange(STEP, PATIENCE, fill_flat).unwrap();
            num_sessions() == 1
        });
        eventually("its shared memory is gone", || domain.shared_memory().len() <= steady);
    }
    assert_eq!(session.num_registrations(), 1);
    drop((session, client));
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn daemon_after_all_processes_were_killed_removes_their_files() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut client = spawn_client(&domain);
    send_signal(&client, Signal::KILL);
    daemon.stop(Signal::KILL);
    client.wait().unwrap();
    assert!(!domain.shared_memory().is_empty(), "the test shows nothing");
    let daemon = Daemon::start(&domain);
    domain.connect().register(sheet(4)).unwrap().exchange(STEP, PATIENCE, fill_flat).unwrap();
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn daemon_signalled_during_a_frame_ends_cleanly() {
    for signal in [Signal::TERM, Signal::INT] {
        let domain = TestDomain::new();
        let daemon = Daemon::start(&domain);
        // Large enough that the daemon is at work when the signal comes.
        let mut session = domain.connect().register(sheet(300)).unwrap();
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        session.publish(STEP, fill_flat).unwrap();
        assert_eq!(daemon.stop(signal).code(), Some(0));
        drop(session);
        domain.assert_nothing_left();
    }
}
