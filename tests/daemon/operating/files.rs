//! Open files: what sessions and observers take is what the daemon makes room for, and observers never take the room of
//! sessions.

use std::process::Command;

use untangled_client::{
    RegisterError, Registration, RequestError, Status,
    observe::{MAX_OBSERVERS, ObserveError, Observer, ObserverOptions},
};
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, sheet, untangled};

fn open_files(daemon: &Daemon) -> usize {
    std::fs::read_dir(format!("/proc/{}/fd", daemon.pid())).unwrap().count()
}

fn options(domain: &TestDomain) -> ObserverOptions {
    ObserverOptions { domain: Some(domain.name().to_owned()), timeout: PATIENCE, name: None }
}

/// A daemon that may have so many files open, and can't change that. Of other tests' sessions in this process it
/// inherits none.
fn daemon_within(domain: &TestDomain, limit: u64) -> Daemon {
    let close = r#"for file in /proc/self/fd/*; do fd=${file##*/}; ((fd > 2)) && eval "exec $fd>&-"; done"#;
    let mut command = Command::new("bash");
    command.args(["-c", &format!(r#"{close}; ulimit -n {limit} && exec "$0" "$@""#)]).arg(untangled());
    command.args(["serve", "--domain", domain.name()]);
    Daemon::start_as(command)
}

#[test]
fn session_takes_the_open_files_that_the_daemon_makes_room_for() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let open = || open_files(&daemon);
    for repairs in [false, true] {
        let session = || {
            let mut session = client.register(Registration { repairs, ..sheet(4) }).unwrap();
            session.exchange(STEP, PATIENCE, fill_flat).unwrap();
            if repairs {
                session.repair(STEP, PATIENCE, fill_flat).unwrap();
            }
            session
        };
        // What requests take on their way is there after the first.
        let first = session();
        let before = open();
        let sessions: Vec<_> = (0..8).map(|_| session()).collect();
        let taken = open() - before;
        println!("repairs {repairs}: {taken} open files for 8 sessions");
        assert!(taken <= 8 * if repairs { 25 } else { 20 }, "{taken}");
        drop((first, sessions));
    }
}

#[test]
fn observers_take_the_open_files_that_the_daemon_makes_room_for() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let open = || open_files(&daemon);
    let mut sessions: Vec<_> = (0..2).map(|_| client.register(sheet(4)).unwrap()).collect();
    let mut exchange = || {
        for session in &mut sessions {
            session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        }
    };
    exchange();
    let before = open();
    let mut observers = Vec::new();
    for _ in 0..MAX_OBSERVERS {
        observers.extend([1, 2].map(|session| Observer::open(options(&domain), session).unwrap()));
    }
    exchange();
    for observer in &mut observers {
        assert!(observer.latest(PATIENCE).unwrap().is_some());
    }
    // What requests take on their way counts elsewhere.
    eventually("16 observers of each of two sessions take 8 open files, and 3 for each observer", || {
        open() - before <= 2 * (8 + 3 * MAX_OBSERVERS)
    });
}

#[test]
fn observers_beyond_the_limit_of_open_files_are_refused_and_cost_no_session_anything() {
    let domain = TestDomain::new();
    // 128 of the daemon, 26 for each of two sessions; 76 are left: for 16 observers of one session, and 4 of the other.
    let daemon = daemon_within(&domain, 256);
    let client = domain.connect();
    let mut first = client.register(Registration { repairs: true, ..sheet(4) }).unwrap();
    let mut observers: Vec<_> = (0..MAX_OBSERVERS).map(|_| Observer::open(options(&domain), 1).unwrap()).collect();
    // The room of the second session is not theirs.
    let mut second = client.register(Registration { repairs: true, ..sheet(5) }).unwrap();
    observers.extend((0..4).map(|_| Observer::open(options(&domain), 2).unwrap()));
    match Observer::open(options(&domain), 2).unwrap_err() {
        ObserveError::Request(RequestError::Refused { status: Status::TooManyObservers, message }) => {
            for words in ["of the 256 files that the daemon may have open, 76 are for those who watch", "at most 2 ses"]
            {
                assert!(message.contains(words), "{message}");
            }
        }
        other => panic!("{other}"),
    }
    for frame in 1..=3 {
        first.exchange(STEP, PATIENCE, fill_flat).unwrap();
        second.exchange(STEP, PATIENCE, fill_flat).unwrap();
        for observer in &mut observers {
            assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().frame(), frame);
        }
    }
    first.repair(STEP, PATIENCE, fill_flat).unwrap();
    assert!(open_files(&daemon) < 256, "{}", open_files(&daemon));
    // The place of one that leaves is free again, and so are those of a session that ends.
    observers.truncate(MAX_OBSERVERS + 3);
    eventually("there is room for one more", || Observer::open(options(&domain), 2).is_ok());
    drop((observers, first));
    eventually("the first session is gone", || client.status().unwrap()["sessions"].as_array().unwrap().len() == 1);
    let again: Vec<_> = (0..MAX_OBSERVERS).map(|_| Observer::open(options(&domain), 2).unwrap()).collect();
    second.exchange(STEP, PATIENCE, fill_flat).unwrap();
    drop(again);
}

#[test]
fn thirty_two_sessions_and_observers_fit_into_a_hard_limit_of_1024_open_files() {
    let domain = TestDomain::new();
    let daemon = daemon_within(&domain, 1024);
    let client = domain.connect();
    let register = || client.register(Registration { repairs: true, ..sheet(4) });
    let mut sessions: Vec<_> = (0..32).map(|_| register().unwrap()).collect();
    // 8 and 3 for each: five of 64 descriptors.
    let mut observers: Vec<_> = (1..=5).map(|session| Observer::open(options(&domain), session).unwrap()).collect();
    let refused = Observer::open(options(&domain), 6).unwrap_err();
    let is_for_room =
        matches!(refused, ObserveError::Request(RequestError::Refused { status: Status::TooManyObservers, .. }));
    assert!(is_for_room, "{refused}");
    match register() {
        Err(RegisterError::Request(RequestError::Refused { status: Status::TooManySessions, message })) => {
            assert!(message.contains("32 sessions are open already"), "{message}");
        }
        other => panic!("{other:?}"),
    }
    for session in &mut sessions {
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        session.repair(STEP, PATIENCE, fill_flat).unwrap();
    }
    for observer in &mut observers {
        assert!(observer.latest(PATIENCE).unwrap().is_some());
    }
    println!("{} open files", open_files(&daemon));
}
