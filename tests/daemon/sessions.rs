//! Sessions with a real daemon: what a host relies on while all peers behave.

use std::{process::Stdio, time::Duration};

use rustix::process::Signal;
use serde_json::json;
use untangled_client::{
    Client, ConnectError, CorrectionKind, Precision, PublishError, RegisterError, Registration, RequestError, Status,
};
use untangled_proto::names::SessionService;
use untangled_testkit::process::{
    Daemon, PATIENCE, STEP, TestDomain, eventually, fill_flat, node, serve, session_service_name, sheet,
};
use untangled_transport::services;

#[test]
fn session_of_each_precision_and_kind_exchanges_frames() {
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
                    Precision::F32 => session.exchange(STEP, PATIENCE, fill_flat).unwrap(),
                    Precision::F64 => session.exchange_f64(STEP, PATIENCE, fill_flat).unwrap(),
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
fn sessions_side_by_side_get_their_own_corrections() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut small = client.register(sheet(4)).unwrap();
    let mut large = domain.connect().register(sheet(20)).unwrap();
    for _ in 0..20 {
        let small_frame = small.publish(STEP, fill_flat).unwrap();
        let large_frame = large.publish(STEP, fill_flat).unwrap();
        assert_eq!(large.wait(large_frame, PATIENCE).unwrap().vertices().len(), 441);
        assert_eq!(small.wait(small_frame, PATIENCE).unwrap().vertices().len(), 25);
    }
    let status = client.status().unwrap();
    assert_eq!(status["schema"], "untangled.status/1");
    assert_eq!(status["sessions"].as_array().unwrap().len(), 2);
    assert_eq!(status["num_frames"], 40);
    drop(small);
    eventually("the small session is gone", || client.status().unwrap()["sessions"].as_array().unwrap().len() == 1);
    large.exchange(STEP, PATIENCE, fill_flat).unwrap();
}

#[test]
fn session_that_never_waits_gets_newer_corrections() {
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
fn corrections_of_a_killed_daemon_stay_readable() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let held: Vec<_> = (0..3).map(|_| session.exchange(STEP, PATIENCE, fill_flat).unwrap()).collect();
    daemon.stop(Signal::KILL);
    for (correction, frame) in held.iter().zip(1..) {
        assert_eq!(correction.header().frame, frame);
        assert_eq!(correction.vertices()[24].value, [0.0; 3]);
    }
}

#[test]
fn client_before_its_daemon_waits_and_connects() {
    let domain = TestDomain::new();
    let options = domain.options();
    let client = std::thread::spawn(move || Client::connect(options));
    let _daemon = Daemon::start(&domain);
    client.join().unwrap().unwrap().register(sheet(2)).unwrap();
}

#[test]
fn client_without_daemon_reports_it_and_leaves_no_files() {
    let domain = TestDomain::new();
    let mut options = domain.options();
    options.timeout = Duration::from_millis(50);
    let error = Client::connect(options).unwrap_err();
    assert!(matches!(error, ConnectError::Request(RequestError::NoDaemon { .. })), "{error}");
    assert!(!domain.0.root().exists());
}

#[test]
fn second_daemon_of_a_domain_is_refused() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let second = serve(&domain).stdout(Stdio::piped()).output().unwrap();
    assert_eq!(second.status.code(), Some(2));
    let message = String::from_utf8(second.stderr).unwrap();
    assert_eq!(
        message,
        format!("untangled: another daemon (process {}) serves domain `{}`\n", daemon.pid(), domain.name())
    );
    domain.connect().register(sheet(2)).unwrap().exchange(STEP, PATIENCE, fill_flat).unwrap();
}

#[test]
fn settings_of_a_session_are_validated_and_updated() {
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
    session.update_settings(json!({"response": "mask"}), PATIENCE).unwrap();
    let error = session.update_settings(json!({"response": "magic"}), PATIENCE).unwrap_err();
    assert!(matches!(error, RequestError::Refused { status: Status::BadSettings, .. }), "{error}");
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
}

#[test]
fn subscriber_to_paths_receives_them() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut session = client.register(sheet(4)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    let node = node(&domain);
    let name = session_service_name(&domain, 1, SessionService::Paths);
    let service = services::open_paths(&node, &name).unwrap();
    let subscriber = service.subscriber_builder().create().unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    let mut received = None;
    eventually("paths", || {
        received = subscriber.receive().unwrap();
        received.is_some()
    });
    let sample = received.unwrap();
    assert_eq!((sample.user_header().frame, sample.user_header().num_paths), (2, 0));
}

#[test]
fn client_in_a_host_installs_no_signal_handlers() {
    let caught = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        status.lines().find(|line| line.starts_with("SigCgt")).unwrap().to_owned()
    };
    let before = caught();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    assert_eq!(caught(), before);
}
