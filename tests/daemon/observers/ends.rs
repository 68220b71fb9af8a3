//! Observers, sessions and daemons that end, are stopped or are killed.

use std::time::Duration;

use rustix::process::Signal;
use untangled_client::observe::ObserveError;
use untangled_testkit::{
    faults,
    process::{Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, sheet},
};

use super::observe;
use crate::{faults::PROGRAMS, machine::busy};

#[test]
fn observers_killed_and_stopped_at_any_moment_cost_the_session_nothing() {
    let _guard = busy();
    let row = faults::observer_faults(PROGRAMS, 60, 20);
    assert!(row.is_clean() && row.num_tries > 0, "{row:?}");
    eprintln!("{row:?}");
}

#[test]
fn observers_hear_that_the_session_has_ended() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    for closes in [true, false] {
        let mut session = client.register(sheet(4)).unwrap();
        let mut observer = observe(&domain);
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().frame(), 1);
        if closes {
            session.close(PATIENCE).unwrap();
        } else {
            drop(session);
        }
        let error = observer.latest(PATIENCE).unwrap_err();
        assert!(matches!(error, ObserveError::SessionEnded { .. }), "{error}");
        assert!(error.is_end() && error.to_string().contains("has ended"), "{error}");
        observer.latest(Duration::ZERO).unwrap_err();
    }
    drop(client);
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn observers_find_their_session_again_after_the_daemon_was_killed() {
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut other = client.register(sheet(4)).unwrap();
    let mut session = client.register(sheet(4)).unwrap();
    let exchange = |session: &mut untangled_client::Session| {
        eventually("the session goes on", || session.exchange(STEP, Duration::from_millis(200), fill_flat).is_ok());
    };
    let found = untangled_client::observe::sessions(&super::options(&domain)).unwrap();
    let mut observer = untangled_client::observe::Observer::open(super::options(&domain), found[1].session).unwrap();
    exchange(&mut session);
    assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().frame(), 1);
    for signal in [Signal::KILL, Signal::TERM] {
        daemon.stop(signal);
        let error = observer.latest(PATIENCE).unwrap_err();
        assert!(matches!(error, ObserveError::DaemonGone { .. }), "{error}");
        let error = observer.reopen(Duration::from_millis(50)).unwrap_err();
        assert!(matches!(error, ObserveError::Connect(_)), "{error}");
        daemon = Daemon::start(&domain);
        exchange(&mut other);
        exchange(&mut session);
        observer.reopen(PATIENCE).unwrap();
        // The second of the two that are alike, which were registered again in their order.
        let found = untangled_client::observe::sessions(&super::options(&domain)).unwrap();
        assert_eq!(observer.session().session, found[1].session);
        let before = session.frame();
        exchange(&mut session);
        // On a busy machine one exchange may take several frames, not all of which are answered.
        let mut num_answered = 0;
        loop {
            let seen = observer.latest(PATIENCE).unwrap().expect("a frame");
            num_answered += 1 + seen.num_dropped;
            if seen.frame() == session.frame() {
                break;
            }
        }
        assert!((1..=session.frame() - before).contains(&num_answered), "{num_answered}");
    }
    drop((observer, session, other, client));
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn views_take_memory_only_while_somebody_watches() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(200)).unwrap();
    let mut frame = || drop(session.exchange(STEP, PATIENCE, fill_flat).unwrap());
    // The first observer's request leaves the services, and makes room for longer replies.
    drop(observe(&domain));
    (0..3).for_each(|_| frame());
    let before = domain.shared_bytes();
    let mut observer = observe(&domain);
    (0..20).for_each(|_| {
        frame();
        assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().positions.len(), 40_401);
    });
    let with = domain.shared_bytes() - before;
    // A few samples of the 33 that there is room for: 485 kB of positions each.
    assert!((485_000..2_500_000).contains(&with), "{with}");
    drop(observer);
    eventually("the memory of the views is given back", || {
        frame();
        domain.shared_bytes() <= before + 50_000
    });
}
