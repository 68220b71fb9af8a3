//! One session: what it gets for a frame that asks for a repair.

use std::time::Duration;

use rustix::process::Signal;
use serde_json::json;
use untangled_client::{Precision, Registration, Repair, RepairError, Session, Status};
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, fill_flat, sheet};

use super::cloth::Tangle;

/// Long enough on any machine.
const LONG: Duration = Duration::from_secs(600);

#[test]
fn tangled_cloth_of_either_precision_is_clean_after_one_exchange() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let cloth = Tangle::gallery();
    assert!(cloth.num_crossings(&cloth.positions) > 20 && !cloth.pins.is_empty());
    let sessions = [Precision::F32, Precision::F64].map(|precision| {
        let mut session = client.register(cloth.registration(precision)).unwrap();
        assert!(session.has_repairs());
        let repair = match precision {
            Precision::F32 => {
                session.repair(STEP, LONG, |slots| slots.copy_from_slice(&cloth.positions_f32())).unwrap()
            }
            Precision::F64 => session.repair_f64(STEP, LONG, |slots| slots.copy_from_slice(&cloth.positions)).unwrap(),
        };
        let repaired = cloth.repaired(&repair);
        assert_eq!(cloth.num_crossings(&repaired), 0, "{:?}", repair.header());
        assert_describes(&repair);
        let before: Vec<[f64; 3]> = match precision {
            Precision::F32 => cloth.positions_f32().iter().map(|position| position.map(f64::from)).collect(),
            Precision::F64 => cloth.positions.clone(),
        };
        for &pin in &cloth.pins {
            assert_eq!(repaired[pin as usize], before[pin as usize], "pin {pin} moved");
        }
        // The correction of the frame came as ever.
        assert_eq!(session.newest().unwrap().unwrap().frame(), 1);
        drop(repair);
        if precision == Precision::F32 {
            assert_stays(&mut session, &repaired);
        }
        session
    });
    let status = client.status().unwrap();
    let certified = status["sessions"].as_array().unwrap().iter().map(|s| s["repairs"]["num_certified"].as_u64());
    assert_eq!(certified.sum::<Option<u64>>(), Some(3));
    drop(sessions);
}

/// The figures of a repair that left nothing.
fn assert_describes(repair: &Repair) {
    let header = repair.header();
    assert!(repair.is_certified() && !repair.is_truncated(), "{header:?}");
    let rest = (header.num_edge_face_intersections, header.num_crossings, header.num_pairs, header.contour_length_m);
    assert_eq!((repair.frame(), header.frame, rest), (1, 1, (0, 0, 0, 0.0)));
    assert!(header.num_iterations > 0 && header.num_moved > 0 && header.repair_ns > 0);
    let (mean, most) = (header.mean_displacement_m, header.max_displacement_m);
    assert!(0.0 < mean && mean <= most && most < 1.0, "{header:?}");
    let [least, largest] = [header.min_edge_ratio, header.max_edge_ratio];
    assert!(0.01 < least && least < 1.0 && 1.0 < largest && largest < 10.0, "{header:?}");
    assert!(0.0 < header.min_area_ratio && header.min_area_ratio < 1.0, "{header:?}");
}

/// Clean cloth is certified as it is.
fn assert_stays(session: &mut Session, clean: &[[f64; 3]]) {
    let again = session.repair(STEP, LONG, |slots| {
        for (slot, position) in slots.iter_mut().zip(clean) {
            #[expect(clippy::cast_possible_truncation, reason = "positions that single precision holds")]
            let position = position.map(|value| value as f32);
            *slot = position;
        }
    });
    let again = again.unwrap();
    assert!(again.is_certified() && again.header().num_moved == 0, "{:?}", again.header());
    assert!(again.displacements_f32().unwrap().iter().all(|step| *step == [0.0; 3]));
}

#[test]
fn repair_whose_time_is_up_sends_the_best_so_far_and_says_so() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let cloth = Tangle::crumple(40);
    let before = cloth.num_crossings(&cloth.positions);
    let settings = json!({"repair_deadline_us": 1});
    let mut session =
        domain.connect().register(Registration { settings, ..cloth.registration(Precision::F64) }).unwrap();
    session.ask_for_repair(None);
    let frame = session.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).unwrap();
    let error = session.wait_repair(frame, PATIENCE).unwrap_err();
    let RepairError::Refused(refusal) = error else { panic!("{error}") };
    assert_eq!((refusal.status, refusal.fault_value, refusal.is_transient()), (Status::OutOfTime, 1.0, true));
    // The frame's own time goes before the setting.
    session.ask_for_repair(Some(Duration::from_millis(800)));
    let frame = session.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).unwrap();
    let repair = session.wait_repair(frame, PATIENCE).unwrap();
    let after = cloth.num_crossings(&cloth.repaired(&repair));
    assert!(repair.is_truncated() && !repair.is_certified(), "{:?}", repair.header());
    assert_eq!(repair.header().num_crossings, after as u64);
    assert!(after <= before && repair.header().num_pairs > 0, "{before} to {after}");
}

#[test]
fn session_without_repairs_and_frame_that_cannot_be_used_are_told_so() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut bare = client.register(sheet(4)).unwrap();
    assert!(!bare.has_repairs() && bare.poll_repair().unwrap().is_none());
    assert!(matches!(bare.repair(STEP, PATIENCE, fill_flat), Err(RepairError::NotOffered)));
    // What nobody answers costs nothing.
    bare.ask_for_repair(None);
    bare.exchange(STEP, PATIENCE, fill_flat).unwrap();
    let mut session = client.register(Registration { repairs: true, ..sheet(4) }).unwrap();
    let error = session.repair(STEP, PATIENCE, |slots| slots.fill([f32::NAN; 3])).unwrap_err();
    let RepairError::Refused(refusal) = error else { panic!("{error}") };
    assert_eq!((refusal.frame, refusal.status, refusal.fault_index), (1, Status::BadPosition, Some(0)));
    assert!(session.repair(STEP, PATIENCE, fill_flat).unwrap().is_certified());
    let settings = json!({"max_face_pairs": 1});
    let cloth = Tangle::gallery();
    let mut limited = client.register(Registration { settings, ..cloth.registration(Precision::F64) }).unwrap();
    let error = limited.repair_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(&cloth.positions)).unwrap_err();
    assert!(
        matches!(error, RepairError::Refused(refusal) if refusal.status == Status::TooManyIntersections),
        "{error}"
    );
}

#[test]
fn session_whose_own_settings_ask_for_repairs_needs_the_service() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    for repair in ["auto", "always"] {
        let settings = json!({ "repair": repair });
        let error = client.register(Registration { settings: settings.clone(), ..sheet(2) }).unwrap_err().to_string();
        assert!(error.contains("repair") && error.contains("option"), "{error}");
        client.register(Registration { settings, repairs: true, ..sheet(2) }).unwrap();
    }
    drop(client);
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}
