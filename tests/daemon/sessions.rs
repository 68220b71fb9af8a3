//! Sessions with a real daemon: what a host relies on while everybody behaves.

#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "what goes wrong fails a test, and zeros are exact")]

#[path = "support/daemon.rs"]
mod support;

use std::{
    process::Stdio,
    time::{Duration, Instant},
};

use rustix::process::Signal;
use serde_json::json;
use support::{DEADLINE, Daemon, STEP, TestDomain, command, eventually, fill_flat, sheet};
use untangled_client::{
    Client, ConnectError, CorrectionKind, Precision, PublishError, RegisterError, Registration, RequestError, Status,
    flags,
};
use untangled_proto::{correction::TRUNCATED, names::SessionService};

#[test]
fn register_and_exchange() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    assert_eq!(client.daemon().pid, daemon.pid());
    for precision in [Precision::F32, Precision::F64] {
        for correction in [
            CorrectionKind::Force,
            CorrectionKind::Acceleration,
            CorrectionKind::VelocityChange,
            CorrectionKind::Displacement,
        ] {
            let mut session = client.register(Registration { precision, correction, ..sheet(8) }).unwrap();
            for frame in 1..=20 {
                let correction_of_frame = match precision {
                    Precision::F32 => session.exchange(STEP, DEADLINE, fill_flat).unwrap(),
                    Precision::F64 => session.exchange_f64(STEP, DEADLINE, fill_flat).unwrap(),
                };
                assert_eq!(correction_of_frame.frame(), frame);
                assert_eq!(correction_of_frame.vertices().len(), 81);
                let header = correction_of_frame.header();
                assert_eq!(header.kind, correction as u32);
                assert_eq!((header.status, header.num_vertices, header.num_face_pairs), (0, 81, 0));
                assert!(correction_of_frame.vertices().iter().all(|vertex| vertex.value == [0.0; 3]));
            }
            let wrong = match precision {
                Precision::F32 => session.publish_f64(STEP, fill_flat).unwrap_err(),
                Precision::F64 => session.publish(STEP, fill_flat).unwrap_err(),
            };
            assert!(matches!(wrong, PublishError::Precision { .. }));
        }
    }
}

#[test]
fn two_sessions_do_not_meet() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut small = client.register(sheet(4)).unwrap();
    let mut large = domain.connect().register(sheet(20)).unwrap();
    for _ in 0..20 {
        let small_frame = small.publish(STEP, fill_flat).unwrap();
        let large_frame = large.publish(STEP, fill_flat).unwrap();
        assert_eq!(large.wait(large_frame, DEADLINE).unwrap().vertices().len(), 441);
        assert_eq!(small.wait(small_frame, DEADLINE).unwrap().vertices().len(), 25);
    }
    let status = client.status().unwrap();
    assert_eq!(status["schema"], "untangled.status/1");
    assert_eq!(status["sessions"].as_array().unwrap().len(), 2);
    assert_eq!(status["num_frames"], 40);
    drop(small);
    eventually("the small session is gone", || client.status().unwrap()["sessions"].as_array().unwrap().len() == 1);
    large.exchange(STEP, DEADLINE, fill_flat).unwrap();
}

/// Events of many clients at once are what the transport loses wake-ups by; the daemon's tick, twice a second, must not be what serves them.
#[test]
fn crowds_are_not_served_by_the_tick() {
    const CLIENTS: usize = 8;
    const FRAMES: usize = 500;
    let tick = Duration::from_millis(400);
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let num_slow: usize = std::thread::scope(|scope| {
        let clients: Vec<_> = (0..CLIENTS)
            .map(|_| {
                scope.spawn(|| {
                    let mut session = domain.connect().register(sheet(1)).unwrap();
                    let mut num_slow = 0;
                    for _ in 0..FRAMES {
                        let begin = Instant::now();
                        session.exchange(STEP, DEADLINE, fill_flat).unwrap();
                        num_slow += usize::from(begin.elapsed() > tick);
                    }
                    num_slow
                })
            })
            .collect();
        clients.into_iter().map(|client| client.join().unwrap()).sum()
    });
    // A machine may stand still for a moment, but not for one frame in a hundred.
    assert!(num_slow < CLIENTS * FRAMES / 100, "{num_slow} of {} frames waited for a tick", CLIENTS * FRAMES);
}

#[test]
fn free_running() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(10)).unwrap();
    let mut newest = 0;
    eventually("fifty frames later", || {
        session.publish(STEP, fill_flat).unwrap();
        if let Some(correction) = session.newest().unwrap() {
            assert!(correction.frame() > newest && correction.frame() <= session.frame());
            newest = correction.frame();
        }
        newest > 50
    });
}

#[test]
fn corrections_stay_readable() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let held: Vec<_> = (0..3).map(|_| session.exchange(STEP, DEADLINE, fill_flat).unwrap()).collect();
    daemon.stop(Signal::KILL);
    for (correction, frame) in held.iter().zip(1..) {
        assert_eq!(correction.header().frame, frame);
        assert_eq!(correction.vertices()[24].value, [0.0; 3]);
    }
}

#[test]
fn a_client_waits_for_a_late_daemon() {
    let domain = TestDomain::new();
    let options = domain.options();
    let client = std::thread::spawn(move || Client::connect(options));
    let _daemon = Daemon::start(&domain);
    client.join().unwrap().unwrap().register(sheet(2)).unwrap();
}

#[test]
fn without_a_daemon_a_client_says_so_and_leaves_nothing() {
    let domain = TestDomain::new();
    let mut options = domain.options();
    options.timeout = Duration::from_millis(50);
    let error = Client::connect(options).unwrap_err();
    assert!(matches!(error, ConnectError::Request(RequestError::NoDaemon { .. })), "{error}");
    assert!(!domain.0.root().exists());
}

#[test]
fn a_second_daemon_is_refused() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let second = command(&domain).stdout(Stdio::piped()).output().unwrap();
    assert_eq!(second.status.code(), Some(2));
    let message = String::from_utf8(second.stderr).unwrap();
    assert_eq!(
        message,
        format!("untangled: another daemon (process {}) serves domain `{}`\n", daemon.pid(), domain.name())
    );
    domain.connect().register(sheet(2)).unwrap().exchange(STEP, DEADLINE, fill_flat).unwrap();
}

#[test]
fn settings_are_checked_and_changed() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let refused = |settings| {
        let error = client.register(Registration { settings, ..sheet(2) }).unwrap_err();
        let RegisterError::Request(RequestError::Refused { status: Status::BadSettings, message }) = error else {
            panic!("{error}")
        };
        message
    };
    assert!(refused(json!({"stiffnes": 1})).contains("stiffnes"));
    assert!(refused(json!({"path_rings": 1000})).contains("path_rings"));
    assert!(refused(json!([1])).contains("settings"));
    let mut session = client.register(Registration { settings: json!({"path_rings": 3}), ..sheet(2) }).unwrap();
    session.update_settings(json!({"response": "mask"}), DEADLINE).unwrap();
    let error = session.update_settings(json!({"response": "magic"}), DEADLINE).unwrap_err();
    assert!(matches!(error, RequestError::Refused { status: Status::BadSettings, .. }), "{error}");
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
}

/// An upright triangle whose tip stands through a flat one.
fn fill_tangled(positions: &mut [[f32; 3]]) {
    positions.copy_from_slice(&[
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.5, 1.0, 2.0],
        [1.5, 1.0, 2.0],
        [1.0, 1.1, -1.0],
    ]);
}

#[test]
fn a_frame_ends_when_time_is_up_and_says_what_is_missing() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let tangle = Registration { num_vertices: 6, triangles: vec![[0, 1, 2], [3, 4, 5]], ..Registration::default() };
    // No frame is that fast.
    let hurried = Registration { settings: json!({"deadline_us": 1}), ..tangle };
    let mut session = client.register(hurried).unwrap();
    let correction = session.exchange(STEP, DEADLINE, fill_tangled).unwrap();
    let header = *correction.header();
    assert_eq!((header.status, header.flags & TRUNCATED, header.num_pairs_left_out), (0, TRUNCATED, 1));
    assert!((header.length_left_out_m - header.contour_length_m).abs() < 1e-12 && header.length_left_out_m > 0.1);
    assert!(correction.vertices().iter().all(|vertex| vertex.value == [0.0; 3]));
    assert_eq!(header.num_face_pairs, 1, "what intersects is always found");
    assert_ne!(correction.vertices()[5].flags & flags::MASK, 0, "the mask holds all the same");
    // Changed while it runs: each kind of setting from the next frame on.
    for (settings, moves) in [
        (json!({}), true),
        (json!({"quality": "fast"}), true),
        (json!({"quality": "accurate", "deadline_us": 1}), false),
        (json!({"quality": "fast", "response": "mask"}), false),
        (json!({"quality": "balanced"}), true),
    ] {
        session.update_settings(settings.clone(), DEADLINE).unwrap();
        let correction = session.exchange(STEP, DEADLINE, fill_tangled).unwrap();
        let header = correction.header();
        assert_eq!(header.num_pairs_left_out, u64::from(settings["deadline_us"] == 1), "{settings}");
        assert_eq!(header.flags & TRUNCATED != 0, header.num_pairs_left_out > 0);
        assert_eq!(correction.vertices()[5].value != [0.0; 3], moves, "{settings}");
    }
    let status = client.status().unwrap();
    assert_eq!(status["sessions"][0]["num_truncated_frames"], 2);
}

#[test]
fn small_sessions_are_served_while_a_large_one_is_at_work() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut large = domain.connect().register(sheet(500)).unwrap();
    let mut small = domain.connect().register(sheet(10)).unwrap();
    let mut most_while_one = 0;
    for _ in 0..5 {
        let frame = large.publish(STEP, fill_flat).unwrap();
        let mut num_small = 0;
        let done = loop {
            small.exchange(STEP, DEADLINE, fill_flat).unwrap();
            match large.newest().unwrap() {
                Some(correction) => break correction,
                None => num_small += 1,
            }
        };
        assert_eq!(done.frame(), frame);
        most_while_one = most_while_one.max(num_small);
    }
    // With one worker for both there would be one at most.
    assert!(most_while_one > 3, "{most_while_one} small frames while a large one was at work");
}

#[test]
fn frames_take_no_more_shared_memory_than_the_registration() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(200)).unwrap();
    let taken = domain.shared_bytes();
    let mut held = Vec::new();
    for frame in 0..12 {
        held.push(session.exchange(STEP, DEADLINE, fill_flat).unwrap());
        if frame % 4 == 3 {
            held.clear();
        } else if held.len() == 3 {
            held.remove(0);
        }
    }
    // A page or so of bookkeeping; a sample that was not taken would be a hundred of them.
    assert!(domain.shared_bytes() <= taken + 65536, "{taken} bytes at first, {} later", domain.shared_bytes());
}

#[test]
fn a_million_triangles() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(708)).unwrap();
    let correction = session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    assert_eq!(correction.vertices().len(), 709 * 709);
}

#[test]
fn paths_reach_whoever_listens() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut session = client.register(sheet(4)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    let node = support::node(&domain);
    let name = support::session_service_name(&domain, 1, SessionService::Paths);
    let service = untangled_transport::services::open_paths(&node, &name).unwrap();
    let subscriber = service.subscriber_builder().create().unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    let mut received = None;
    eventually("paths", || {
        received = subscriber.receive().unwrap();
        received.is_some()
    });
    let sample = received.unwrap();
    assert_eq!((sample.user_header().frame, sample.user_header().num_paths), (2, 0));
}

#[test]
fn an_idle_daemon_uses_no_cpu() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    let ticks = || {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", daemon.pid())).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    };
    // One quiet window of several: on a crowded machine even housekeeping may be charged a tick or two.
    let used: Vec<u64> = (0..5)
        .map(|_| {
            let before = ticks();
            std::thread::sleep(Duration::from_secs(2));
            ticks() - before
        })
        .take_while(|&used| used > 1)
        .collect();
    assert!(used.len() < 5, "ticks of CPU time while idle, in windows of two seconds: {used:?}");
}

#[test]
fn a_client_leaves_its_hosts_signals_alone() {
    let caught = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        status.lines().find(|line| line.starts_with("SigCgt")).unwrap().to_owned()
    };
    let before = caught();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    assert_eq!(caught(), before);
}
