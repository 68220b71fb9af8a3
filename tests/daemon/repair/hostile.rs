//! Hosts that flood the daemon with repairs, leave in the middle of one, or ask for them with frames of no use.

use std::time::Duration;

use serde_json::{Value, json};
use untangled_client::{Precision, Registration, RepairError};
use untangled_proto::Status;
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, serve, sheet};

use super::cloth::Tangle;
use crate::machine::busy;

/// A daemon with one thread for repairs, so that what holds it keeps all others waiting.
fn daemon(domain: &TestDomain) -> Daemon {
    let mut command = serve(domain);
    command.env("UNTANGLED_NUM_REPAIR_WORKERS", "1");
    Daemon::start_as(command)
}

fn repairs(status: &Value) -> [u64; 2] {
    ["num_sent", "num_replaced"].map(|name| status["repairs"][name].as_u64().unwrap())
}

#[test]
fn flood_of_repair_requests_keeps_one_waiting_and_others_are_repaired() {
    let _guard = busy();
    let domain = TestDomain::new();
    let _daemon = daemon(&domain);
    let client = domain.connect();
    let cloth = Tangle::crumple(24);
    let settings = json!({"repair": "always", "repair_deadline_us": 200_000});
    let registration = Registration { settings, ..cloth.registration(Precision::F64) };
    let mut flooding = client.register(registration).unwrap();
    let mut other = client.register(sheet(20)).unwrap();
    let mut frame = 0;
    for _ in 0..200 {
        flooding.ask_for_repair(Some(Duration::from_millis(200)));
        frame = flooding.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).unwrap();
        flooding.wait(frame, PATIENCE).unwrap();
        other.exchange(STEP, PATIENCE, fill_flat).unwrap();
    }
    // Another session's repair comes after the one in work, not after the flood.
    let small = Tangle::small();
    let mut second = client.register(small.registration(Precision::F64)).unwrap();
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&small.positions);
    assert!(second.repair_f64(STEP, Duration::from_secs(600), fill).unwrap().is_certified());
    // The last request is answered too, if only to say that its time was up before it was begun.
    let last = flooding.wait_repair(frame, PATIENCE);
    assert!(matches!(&last, Ok(_) | Err(RepairError::Refused(_))), "{last:?}");
    drop(last);
    // Each request was answered or replaced, and the daemon counts both.
    let [num_sent, num_replaced] = repairs(&client.status().unwrap());
    assert_eq!(num_sent + num_replaced, 201);
    assert!(num_replaced > 0);
}

#[test]
fn sessions_that_close_in_the_middle_of_repairs_leave_the_thread_to_others() {
    let _guard = busy();
    let domain = TestDomain::new();
    let daemon = daemon(&domain);
    let client = domain.connect();
    let cloth = Tangle::crumple(40);
    for number in 0..20 {
        let mut session = client.register(cloth.registration(Precision::F64)).unwrap();
        session.ask_for_repair(None);
        let frame = session.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).unwrap();
        if number % 2 == 0 {
            session.wait(frame, PATIENCE).unwrap();
        }
        if number % 4 < 2 {
            session.close(PATIENCE).unwrap();
        }
    }
    let small = Tangle::small();
    let mut next = client.register(small.registration(Precision::F64)).unwrap();
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&small.positions);
    assert!(next.repair_f64(STEP, Duration::from_secs(600), fill).unwrap().is_certified());
    drop(next);
    eventually("all sessions have ended", || client.status().unwrap()["sessions"].as_array().unwrap().is_empty());
    drop(client);
    assert!(daemon.stop(rustix::process::Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn repair_of_a_frame_of_no_use_is_answered_with_its_fault() {
    let domain = TestDomain::new();
    let _daemon = daemon(&domain);
    let client = domain.connect();
    let small = Tangle::small();
    let mut session = client.register(small.registration(Precision::F64)).unwrap();
    for _ in 0..20 {
        session.ask_for_repair(None);
        let frame = session
            .publish_f64(STEP, |slots| {
                slots.copy_from_slice(&small.positions);
                slots[7][1] = f64::NAN;
            })
            .unwrap();
        session.wait(frame, PATIENCE).unwrap_err();
        let repair = session.wait_repair(frame, PATIENCE);
        let status =
            repair.as_ref().map_or_else(|error| error.to_string(), |repair| repair.header().status.to_string());
        assert!(repair.is_err() || status == Status::BadPosition.code().to_string(), "{status}");
    }
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&small.positions);
    assert!(session.repair_f64(STEP, Duration::from_secs(600), fill).unwrap().is_certified());
}
