//! What a daemon refuses, and in which words; and replies that a client refuses.

use std::time::Duration;

use iceoryx2::prelude::EventId;
use untangled_client::{
    Client, CorrectionKind, ExchangeError, RegisterError, Registration, RequestError, Session, Status, StepTime, Uvs,
    WaitError,
};
use untangled_proto::{
    ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, PayloadLayout, PositionF32, RegisterParams, ReplyHeader,
    RequestHeader, RequestKind, StateHeader,
    control::Hello,
    names,
    sections::{SectionWriter, id},
};
use untangled_testkit::process::{Daemon, PATIENCE, RawPeer, STEP, TestDomain, eventually, fill_flat, node, sheet};
use untangled_transport::{lock::DomainLock, services};

fn refusal(result: Result<Session, RegisterError>) -> (Status, String) {
    match result {
        Err(RegisterError::Request(RequestError::Refused { status, message })) => (status, message),
        other => panic!("{other:?}"),
    }
}

#[test]
fn request_of_another_protocol_version_is_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let header = RequestHeader { protocol_version: 999, kind: RequestKind::Hello as u32, ..RequestHeader::default() };
    let (reply, words) = RawPeer::new(&domain).expect_reply(header, &[]);
    assert_eq!(reply.status, Status::UnsupportedProtocol.code());
    assert_eq!(reply.protocol_version, PROTOCOL_VERSION);
    assert!(words.contains("protocol 999"), "{words}");
}

/// The daemon is the test itself: its first reply bears the token of another request, as one that comes late.
#[test]
fn client_given_a_reply_to_another_request_ignores_it() {
    let domain = TestDomain::new();
    let mut lock = DomainLock::acquire(&domain.0).unwrap();
    let node = node(&domain);
    let _requests = services::create_shared_event(&node, names::CONTROL).unwrap();
    let replies = services::create_shared_event(&node, names::REPLY).unwrap();
    let notifier = replies.notifier_builder().create().unwrap();
    let control = services::create_requests(&node, PayloadLayout::Packed).unwrap();
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
            features: Vec::new(),
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

/// The daemon is the test itself: it answers as those did that know no bodies, and ignore the section.
#[test]
fn client_whose_daemon_takes_a_body_for_cloth_refuses_the_session_in_words() {
    let domain = TestDomain::new();
    let mut lock = DomainLock::acquire(&domain.0).unwrap();
    let node = node(&domain);
    let _requests = services::create_shared_event(&node, names::CONTROL).unwrap();
    let replies = services::create_shared_event(&node, names::REPLY).unwrap();
    let notifier = replies.notifier_builder().create().unwrap();
    let control = services::create_requests(&node, PayloadLayout::Packed).unwrap();
    let server = control.server_builder().initial_max_slice_len(4096).create().unwrap();
    lock.announce().unwrap();
    let options = domain.options();
    let registering = std::thread::spawn(move || {
        Client::connect(options).unwrap().register(Registration { body: (0..9).collect(), ..sheet(2) }).map(drop)
    });
    for (kind, session) in [(RequestKind::Hello, 0), (RequestKind::Register, 1)] {
        let mut request = None;
        eventually("a request", || {
            request = server.receive().unwrap();
            request.is_some()
        });
        let request = request.unwrap();
        let (token, asked) = (request.user_header().token, request.user_header().kind);
        assert_eq!(asked, kind as u32);
        let text = match kind {
            RequestKind::Hello => format!(
                r#"{{"protocol_version": {PROTOCOL_VERSION}, "library_version": "{LIBRARY_VERSION}",
                "iceoryx2_version": "{ICEORYX2_VERSION}", "pid": 1, "features": ["sparse", "labels", "repair"]}}"#
            ),
            _ => String::new(),
        };
        let mut reply = request.loan_slice_uninit(text.len()).unwrap();
        let protocol_version = PROTOCOL_VERSION;
        *reply.user_header_mut() = ReplyHeader { protocol_version, session, token, ..ReplyHeader::default() };
        reply.write_from_slice(text.as_bytes()).send().unwrap();
        notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY)).unwrap();
    }
    let error = registering.join().unwrap().unwrap_err();
    assert!(error.to_string().contains("too old to know bodies"), "{error}");
}

#[test]
fn malformed_requests_are_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let peer = RawPeer::new(&domain);
    let refused = |kind: u32, num_sections, session, payload: &[u8], words: &str| {
        let header =
            RequestHeader { protocol_version: PROTOCOL_VERSION, kind, num_sections, session, ..Default::default() };
        let (reply, text) = peer.expect_reply(header, payload);
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
fn registration_of_a_bad_mesh_is_refused_with_the_element_at_fault() {
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
    client.register(sheet(2)).unwrap().exchange(STEP, PATIENCE, fill_flat).unwrap();
}

#[test]
fn frame_with_bad_values_is_refused_and_the_session_continues() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let mut refused = |step, spoil: &dyn Fn(&mut [[f32; 3]])| {
        let result = session.exchange(step, PATIENCE, |positions| {
            fill_flat(positions);
            spoil(positions);
        });
        let Err(ExchangeError::Wait(WaitError::Refused(refusal))) = result else { panic!("{result:?}") };
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
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
fn state_of_the_wrong_length_is_refused() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let peer = RawPeer::new(&domain);
    let session = peer.session(100);
    for (length, num_vertices, frame, status) in [
        (0, 3, 1, Status::BadHeader),
        (100, 3, 2, Status::BadHeader),
        (3, 100, 3, Status::BadHeader),
        (3, 3, 4, Status::Ok),
    ] {
        let mut sample = session.states.loan_slice_uninit(length).unwrap();
        *sample.user_header_mut() = StateHeader { frame, dt_s: 0.01, num_vertices, ..StateHeader::default() };
        sample.write_from_fn(|_| PositionF32::default()).send().unwrap();
        peer.wake(names::EVENT_STATE);
        let (header, values) = peer.answer(&session, frame).unwrap();
        assert_eq!((header.frame, header.status), (frame, status.code()));
        assert_eq!(values.len(), 3);
    }
}
