//! Repairs beside frames, of the same session and of others, and peers that end meanwhile.

use std::time::Duration;

use rustix::process::Signal;
use serde_json::json;
use untangled_client::{Precision, Registration, RepairError, Session};
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, sheet};

use super::cloth::Tangle;
use crate::machine::busy;

/// A cloth whose repair takes longer than the frames of any test.
fn endless() -> Tangle {
    Tangle::crumple(60)
}

fn publish(session: &mut Session, cloth: &Tangle) -> u64 {
    session.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).unwrap()
}

fn ask(session: &mut Session, cloth: &Tangle) -> u64 {
    session.ask_for_repair(None);
    publish(session, cloth)
}

#[test]
fn frames_of_all_sessions_are_answered_while_a_repair_is_in_work() {
    let _guard = busy();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let cloth = endless();
    let mut tangled = client.register(cloth.registration(Precision::F64)).unwrap();
    let frame = ask(&mut tangled, &cloth);
    tangled.wait(frame, PATIENCE).unwrap();
    let mut other = client.register(sheet(20)).unwrap();
    for _ in 0..50 {
        other.exchange(STEP, PATIENCE, fill_flat).unwrap();
    }
    for _ in 0..3 {
        let frame = publish(&mut tangled, &cloth);
        tangled.wait(frame, PATIENCE).unwrap();
    }
    // A repair of another session does not wait for it either.
    let small = Tangle::small();
    let mut second = client.register(small.registration(Precision::F64)).unwrap();
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&small.positions);
    assert!(second.repair_f64(STEP, Duration::from_secs(600), fill).unwrap().is_certified());
    assert!(tangled.poll_repair().unwrap().is_none(), "the long repair came before all of these: make it longer");
    assert_eq!(repairs(&client.status().unwrap(), 0)["num_sent"], 0);
}

fn repairs(status: &serde_json::Value, session: usize) -> serde_json::Value {
    status["sessions"][session]["repairs"].clone()
}

#[test]
fn newest_request_of_a_session_replaces_those_that_wait() {
    let _guard = busy();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let cloth = Tangle::crumple(40);
    let mut session = client.register(cloth.registration(Precision::F64)).unwrap();
    let clean: Vec<[f64; 3]> = (0..41 * 41).map(|k| [f64::from(k / 41), f64::from(k % 41), 0.0]).collect();
    // The first takes all of its time; the others come meanwhile.
    session.ask_for_repair(Some(Duration::from_secs(6)));
    let first = publish(&mut session, &cloth);
    session.wait(first, PATIENCE).unwrap();
    let mut last = first;
    for _ in 0..3 {
        session.ask_for_repair(None);
        last = session.publish_f64(STEP, |slots| slots.copy_from_slice(&clean)).unwrap();
        session.wait(last, PATIENCE).unwrap();
    }
    let repair = session.wait_repair(last, PATIENCE).unwrap();
    assert!(repair.is_certified(), "{:?}", repair.header());
    assert!(repair.header().num_replaced > 0);
    let counts = repairs(&client.status().unwrap(), 0);
    assert_eq!(counts["num_sent"].as_u64().unwrap() + counts["num_replaced"].as_u64().unwrap(), 4);
}

#[test]
fn repair_ends_with_its_session_its_host_and_its_daemon() {
    let _guard = busy();
    let domain = TestDomain::new();
    let daemon = Daemon::start_as({
        let mut command = untangled_testkit::process::serve(&domain);
        command.env("UNTANGLED_NUM_REPAIR_WORKERS", "1");
        command
    });
    let client = domain.connect();
    let cloth = endless();
    let small = Tangle::small();
    for closes in [true, false] {
        let mut session = client.register(cloth.registration(Precision::F64)).unwrap();
        let frame = ask(&mut session, &cloth);
        session.wait(frame, PATIENCE).unwrap();
        if closes {
            session.close(PATIENCE).unwrap();
        } else {
            drop(session);
        }
        // The only worker is free again.
        let mut next = client.register(small.registration(Precision::F64)).unwrap();
        let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&small.positions);
        assert!(next.repair_f64(STEP, Duration::from_secs(600), fill).unwrap().is_certified());
    }
    let mut session = client.register(cloth.registration(Precision::F64)).unwrap();
    let frame = ask(&mut session, &cloth);
    session.wait(frame, PATIENCE).unwrap();
    assert!(daemon.stop(Signal::TERM).success());
    let error = session.wait_repair(frame, PATIENCE).unwrap_err();
    assert!(matches!(error, RepairError::DaemonLost { .. }), "{error}");
    drop((session, client));
    domain.assert_nothing_left();
}

#[test]
fn repair_of_a_daemon_that_is_killed_is_asked_for_again() {
    let _guard = busy();
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let cloth = Tangle::gallery();
    let mut session = domain.connect().register(cloth.registration(Precision::F64)).unwrap();
    ask(&mut session, &cloth);
    daemon.stop(Signal::KILL);
    let daemon = Daemon::start(&domain);
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&cloth.positions);
    let mut repaired = None;
    eventually("the session is repaired", || {
        repaired = session.repair_f64(STEP, PATIENCE, fill).ok();
        repaired.is_some()
    });
    assert!(repaired.is_some_and(|repair| repair.is_certified()));
    drop(session);
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn always_repairs_each_tangled_frame_and_no_clean_one() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let cloth = Tangle::gallery();
    let settings = json!({"repair": "always"});
    let mut session =
        domain.connect().register(Registration { settings, ..cloth.registration(Precision::F64) }).unwrap();
    let frame = publish(&mut session, &cloth);
    let repair = session.wait_repair(frame, Duration::from_secs(600)).unwrap();
    let clean = cloth.repaired(&repair);
    drop(repair);
    let frame = session.publish_f64(STEP, |slots| slots.copy_from_slice(&clean)).unwrap();
    session.wait(frame, PATIENCE).unwrap();
    assert!(session.poll_repair().unwrap().is_none());
    let frame = publish(&mut session, &cloth);
    assert!(session.wait_repair(frame, Duration::from_secs(600)).unwrap().is_certified());
}
