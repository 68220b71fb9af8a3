//! Frames that the daemon repairs by itself, where a tangle does not shrink.

use std::time::Duration;

use rustix::process::Signal;
use serde_json::json;
use untangled_client::{ExchangeError, Precision, PublishError, Registration, Session, WaitError};
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, eventually};

use super::cloth::Tangle;

/// Frames in which a tangle stays as it is before it is repaired: the first is the best so far, and ten are waited for.
const PATIENT_FRAMES: u64 = 11;

fn automatic(cloth: &Tangle) -> Registration {
    Registration { settings: json!({"repair": "auto"}), ..cloth.registration(Precision::F64) }
}

/// Exchanges a frame of these positions, also where the daemon was restarted; the number of repairs that the daemon
/// has begun by itself in this motion.
fn exchange(session: &mut Session, positions: &[[f64; 3]]) -> u64 {
    let mut num_repairs = 0;
    eventually("a frame is answered", || {
        match session.exchange_f64(STEP, PATIENCE, |slots| slots.copy_from_slice(positions)) {
            Ok(correction) => {
                num_repairs = correction.header().progress[1] >> 48;
                assert_eq!(correction.is_being_repaired(), num_repairs > 0);
                true
            }
            Err(
                ExchangeError::Publish(PublishError::Reconnecting) | ExchangeError::Wait(WaitError::DaemonLost { .. }),
            ) => false,
            Err(error) => panic!("{error}"),
        }
    });
    num_repairs
}

#[test]
fn tangle_that_does_not_shrink_is_repaired_without_being_asked_for() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let cloth = Tangle::small();
    let mut session = client.register(automatic(&cloth)).unwrap();
    for frame in 1..PATIENT_FRAMES {
        assert_eq!(exchange(&mut session, &cloth.positions), 0, "frame {frame}");
    }
    assert_eq!(exchange(&mut session, &cloth.positions), 1);
    let repair = session.wait_repair(PATIENT_FRAMES, Duration::from_secs(600)).unwrap();
    assert!(repair.is_certified(), "{:?}", repair.header());
    let clean = cloth.repaired(&repair);
    drop(repair);
    // Clean cloth begins anew, and is not repaired.
    for _ in 0..2 * PATIENT_FRAMES {
        assert_eq!(exchange(&mut session, &clean), 0);
    }
    assert!(session.poll_repair().unwrap().is_none());
    // Another motion has not waited yet.
    for _ in 0..3 {
        for _ in 1..PATIENT_FRAMES {
            assert_eq!(exchange(&mut session, &cloth.positions), 0);
        }
        session.begin_motion();
    }
    assert_eq!(client.status().unwrap()["sessions"][0]["repairs"]["num_sent"], 1);
}

#[test]
fn restarted_daemon_repairs_at_the_same_frame_as_one_that_was_not() {
    let domain = TestDomain::new();
    let cloth = Tangle::small();
    let mut daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(automatic(&cloth)).unwrap();
    for frame in 1..PATIENT_FRAMES {
        if frame % 4 == 0 {
            daemon.stop(if frame == 4 { Signal::KILL } else { Signal::TERM });
            daemon = Daemon::start(&domain);
        }
        assert_eq!(exchange(&mut session, &cloth.positions), 0, "frame {frame}");
    }
    assert_eq!(session.num_registrations(), 3);
    assert_eq!(exchange(&mut session, &cloth.positions), 1);
    let frame = session.frame();
    assert!(session.wait_repair(frame, Duration::from_secs(600)).unwrap().is_certified());
    drop(daemon);
}
