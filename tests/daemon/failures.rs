//! Sessions with a real daemon: peers that die, lie, or come from another age.

#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "what goes wrong fails a test, and zeros are exact")]

#[path = "support/daemon.rs"]
mod support;

use std::{
    io::{BufRead, BufReader},
    process::{Child, Command, Stdio},
    time::Duration,
};

use iceoryx2::prelude::EventId;
use rustix::process::{Signal, kill_process};
use support::{DEADLINE, Daemon, STEP, TestDomain, eventually, fill_flat, node, request, session_service_name, sheet};
use untangled_client::{
    Client, CorrectionKind, ExchangeError, PublishError, RegisterError, Registration, RequestError, Session, Status,
    StepTime, Uvs, WaitError,
};
use untangled_proto::{ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, PositionF32, RegisterParams, ReplyHeader, RequestHeader, RequestKind, StateHeader, control::Hello, names::{self, SessionService}, sections::{SectionWriter, id}};
use untangled_transport::{lock::DomainLock, services};

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

fn refusal(result: Result<Session, RegisterError>) -> (Status, String) {
    match result {
        Err(RegisterError::Request(RequestError::Refused { status, message })) => (status, message),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_session_survives_its_daemon() {
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(8)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    for (signal, num_registrations) in [(Signal::KILL, 2), (Signal::TERM, 3), (Signal::KILL, 4)] {
        let frame = session.publish(STEP, fill_flat).unwrap();
        session.wait(frame, DEADLINE).unwrap();
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
fn a_free_running_host_never_notices_more_than_a_pause() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(8)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
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

/// The client that the next test kills; by itself it is no test.
#[test]
#[ignore = "run as a process of its own by a_killed_client_is_cleaned_up"]
fn client_process() {
    let Ok(domain) = std::env::var("TEST_CLIENT_DOMAIN") else { return };
    let options = untangled_client::ClientOptions { domain: Some(domain), timeout: DEADLINE };
    let mut session = Client::connect(options).unwrap().register(sheet(30)).unwrap();
    let _held = session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    loop {
        println!("frame {}", session.exchange(STEP, DEADLINE, fill_flat).unwrap().frame());
    }
}

fn spawn_client(domain: &TestDomain) -> Child {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "client_process", "--ignored", "--nocapture"])
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
fn a_killed_client_is_cleaned_up() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut session = client.register(sheet(8)).unwrap();
    session.exchange(STEP, DEADLINE, fill_flat).unwrap();
    let num_sessions = || client.status().unwrap()["sessions"].as_array().unwrap().len();
    let steady = domain.shared_memory().len();
    for _ in 0..3 {
        let mut other = spawn_client(&domain);
        assert_eq!(num_sessions(), 2);
        kill_process(support::pid(&other), Signal::KILL).unwrap();
        other.wait().unwrap();
        eventually("its session is gone", || {
            session.exchange(STEP, DEADLINE, fill_flat).unwrap();
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
fn everybody_killed_leaves_nothing_behind_the_next_daemon() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut client = spawn_client(&domain);
    kill_process(support::pid(&client), Signal::KILL).unwrap();
    daemon.stop(Signal::KILL);
    client.wait().unwrap();
    assert!(!domain.shared_memory().is_empty(), "the test shows nothing");
    let daemon = Daemon::start(&domain);
    domain.connect().register(sheet(4)).unwrap().exchange(STEP, DEADLINE, fill_flat).unwrap();
    assert!(daemon.stop(Signal::TERM).success());
    domain.assert_nothing_left();
}

#[test]
fn a_daemon_ends_cleanly_amid_frames() {
    for signal in [Signal::TERM, Signal::INT] {
        let domain = TestDomain::new();
        let daemon = Daemon::start(&domain);
        // Large enough that the daemon is at work when the signal comes.
        let mut session = domain.connect().register(sheet(300)).unwrap();
        session.exchange(STEP, DEADLINE, fill_flat).unwrap();
        session.publish(STEP, fill_flat).unwrap();
        assert_eq!(daemon.stop(signal).code(), Some(0));
        drop(session);
        assert_eq!(domain.shared_memory(), Vec::<String>::new());
        assert_eq!(domain.files(), Vec::<std::path::PathBuf>::new());
    }
}

#[test]
fn other_versions_are_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let header = RequestHeader { protocol_version: 999, kind: RequestKind::Hello as u32, ..RequestHeader::default() };
    let (reply, words) = request(&domain, header, &[]);
    assert_eq!(reply.status, Status::UnsupportedProtocol.code());
    assert_eq!(reply.protocol_version, PROTOCOL_VERSION);
    assert!(words.contains("protocol 999"), "{words}");
}

/// The daemon is the test itself: its first reply bears the token of somebody else's request, as one that comes late.
#[test]
fn the_reply_to_another_request_is_not_taken() {
    let domain = TestDomain::new();
    let mut lock = DomainLock::acquire(&domain.0).unwrap();
    let node = node(&domain);
    let _requests = services::create_shared_event(&node, names::CONTROL).unwrap();
    let replies = services::create_shared_event(&node, names::REPLY).unwrap();
    let notifier = replies.notifier_builder().create().unwrap();
    let control = services::create_control(&node).unwrap();
    let server = control.server_builder().initial_max_slice_len(4096).create().unwrap();
    lock.announce().unwrap();
    let options = domain.options();
    let connecting = std::thread::spawn(move || Client::connect(options));
    let mut request = None;
    eventually("a request", || {
        request = server.receive().unwrap();
        request.is_some()
    });
    let request = request.unwrap();
    let token = request.user_header().token;
    assert_ne!(token, [0; 2]);
    let reply = |token, pid| {
        let hello = Hello {
            protocol_version: PROTOCOL_VERSION,
            library_version: LIBRARY_VERSION.to_owned(),
            iceoryx2_version: ICEORYX2_VERSION.to_owned(),
            pid,
        };
        let text = serde_json::to_string(&hello).unwrap();
        let mut reply = request.loan_slice_uninit(text.len()).unwrap();
        *reply.user_header_mut() = ReplyHeader { protocol_version: PROTOCOL_VERSION, token, ..ReplyHeader::default() };
        reply.write_from_slice(text.as_bytes()).send().unwrap();
        notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY)).unwrap();
    };
    reply([token[0], !token[1]], 1);
    // Time to look at it: the place for replies holds one.
    std::thread::sleep(Duration::from_millis(200));
    reply(token, 2);
    assert_eq!(connecting.join().unwrap().unwrap().daemon().pid, 2);
}

#[test]
fn malformed_requests_are_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let refused = |kind: u32, num_sections, session, payload: &[u8], words: &str| {
        let header =
            RequestHeader { protocol_version: PROTOCOL_VERSION, kind, num_sections, session, ..Default::default() };
        let (reply, text) = request(&domain, header, payload);
        assert!(text.contains(words), "{text}");
        Status::from_code(reply.status).unwrap()
    };
    let register = RequestKind::Register as u32;
    assert_eq!(refused(77, 0, 0, &[], "kind 77"), Status::BadRequest);
    assert_eq!(refused(register, u32::MAX, 0, &[], "sections"), Status::BadRequest);
    assert_eq!(refused(register, 2, 0, &[0; 47], "table"), Status::BadRequest);
    assert_eq!(refused(register, 1, 0, &[255; 24], "offset"), Status::BadRequest);
    assert_eq!(refused(register, 0, 0, &[], "section 1"), Status::BadRequest);
    assert_eq!(refused(RequestKind::Close as u32, 0, 5, &[], "session 5"), Status::UnknownSession);
    let params = |num_vertices, precision, correction| {
        let params = RegisterParams { num_vertices, precision, correction, ..RegisterParams::default() };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]).finish()
    };
    let (payload, num) = params(u64::MAX, 0, 3);
    assert_eq!(refused(register, num, 0, &payload, "vertices"), Status::TooLarge);
    let (payload, num) = params(3, 9, 3);
    assert_eq!(refused(register, num, 0, &payload, "precision 9"), Status::BadRequest);
    let (payload, num) = params(3, 0, 9);
    assert_eq!(refused(register, num, 0, &payload, "correction 9"), Status::BadRequest);
}

#[test]
fn bad_meshes_are_refused_with_the_element_at_fault() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut mesh = sheet(2);
    mesh.triangles[5][1] = 1000;
    let (status, words) = refusal(client.register(mesh));
    assert_eq!(status, Status::BadMesh);
    assert!(words.contains("face 5") && words.contains("1000"), "{words}");
    let mut mesh = sheet(2);
    mesh.masses_kg.as_mut().unwrap()[3] = f64::NAN;
    let (status, words) = refusal(client.register(mesh));
    assert_eq!(status, Status::BadMesh);
    assert!(words.contains("masses") && words.contains("entry 3"), "{words}");
    let uvs = Some(Uvs { coordinates: vec![[0.0; 2]], corners: vec![[0, 0, 1]; 8] });
    let (status, words) = refusal(client.register(Registration { uvs, ..sheet(2) }));
    assert_eq!(status, Status::BadMesh, "{words}");
    let (status, _) = refusal(client.register(Registration { pins: vec![9], ..sheet(2) }));
    assert_eq!(status, Status::BadMesh);
    let forces = Registration { masses_kg: None, correction: CorrectionKind::Force, ..sheet(2) };
    assert_eq!(refusal(client.register(forces)).0, Status::MassesRequired);
    client.register(sheet(2)).unwrap().exchange(STEP, DEADLINE, fill_flat).unwrap();
}

#[test]
fn a_bad_frame_is_refused_and_the_session_lives_on() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let mut refused = |step, spoil: &dyn Fn(&mut [[f32; 3]])| {
        let result = session.exchange(step, DEADLINE, |positions| {
            fill_flat(positions);
            spoil(positions);
        });
        let Err(ExchangeError::Wait(WaitError::Refused(refusal))) = result else { panic!("{result:?}") };
        session.exchange(STEP, DEADLINE, fill_flat).unwrap();
        refusal
    };
    let nan = refused(STEP, &|positions| positions[7][1] = f32::NAN);
    assert_eq!((nan.status, nan.fault_index), (Status::BadPosition, Some(7)));
    assert!(nan.fault_value.is_nan());
    let infinite = refused(STEP, &|positions| positions[24][2] = f32::INFINITY);
    assert_eq!((infinite.status, infinite.fault_index), (Status::BadPosition, Some(24)));
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = refused(StepTime { dt_s, ..STEP }, &|_| {});
        assert_eq!((bad.status, bad.fault_index), (Status::BadHeader, None));
    }
}

#[test]
fn a_state_of_the_wrong_length_is_refused() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let (payload, num_sections) = {
        let params = RegisterParams { num_vertices: 3, precision: 0, correction: 3, ..RegisterParams::default() };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]).finish()
    };
    let kind = RequestKind::Register as u32;
    let header = RequestHeader { protocol_version: PROTOCOL_VERSION, kind, num_sections, ..RequestHeader::default() };
    assert_eq!(request(&domain, header, &payload).0.session, 1);
    let node = node(&domain);
    let name = |service| session_service_name(&domain, 1, service);
    let corrections = services::open_corrections(&node, &name(SessionService::Correction)).unwrap();
    let corrections = corrections.subscriber_builder().create().unwrap();
    let states = services::open_states::<PositionF32>(&node, &name(SessionService::State)).unwrap();
    let states = states.publisher_builder().initial_max_slice_len(100).create().unwrap();
    let event = services::open_event(&node, names::CONTROL).unwrap();
    let notifier = event.notifier_builder().create().unwrap();
    for (length, num_vertices, frame, status) in [
        (0, 3, 1, Status::BadHeader),
        (100, 3, 2, Status::BadHeader),
        (3, 100, 3, Status::BadHeader),
        (3, 3, 4, Status::Ok),
    ] {
        let mut sample = states.loan_slice_uninit(length).unwrap();
        *sample.user_header_mut() = StateHeader { frame, dt_s: 0.01, num_vertices, ..StateHeader::default() };
        sample.write_from_fn(|_| PositionF32::default()).send().unwrap();
        notifier.notify().unwrap();
        let mut answer = None;
        eventually("an answer", || {
            answer = corrections.receive().unwrap();
            answer.is_some()
        });
        let answer = answer.unwrap();
        assert_eq!((answer.user_header().frame, answer.user_header().status), (frame, status.code()));
        assert_eq!(answer.payload().len(), 3);
    }
}
