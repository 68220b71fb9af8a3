//! A frozen client of protocol 1 against the daemon of this build.
//!
//! Nothing here uses `untangled_proto`: structs, names and numbers are those of the first release, and must not change
//! with that crate. A daemon that this test fails against needs a new version of the protocol; a version that is no
//! longer served turns the exchange below into a refusal.

use iceoryx2::{
    port::{publisher::Publisher, subscriber::Subscriber},
    prelude::{Alignment, EventId, Node, NodeBuilder, ServiceName, SignalHandlingMode, ZeroCopySend, ipc_threadsafe},
};
use untangled_testkit::process::{Daemon, TestDomain, eventually};

type Ipc = ipc_threadsafe::Service;
type States = Publisher<Ipc, [PositionF32], StateHeader>;
type Corrections = Subscriber<Ipc, [VertexCorrection], CorrectionHeader>;

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.control.RequestHeader")]
struct RequestHeader {
    protocol_version: u32,
    kind: u32,
    session: u64,
    num_sections: u32,
    flags: u32,
    reserved: [u64; 5],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.control.ReplyHeader")]
struct ReplyHeader {
    protocol_version: u32,
    status: u32,
    instance: u64,
    session: u64,
    reserved: [u64; 5],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.StateHeader")]
struct StateHeader {
    frame: u64,
    simulated_s: f64,
    dt_s: f64,
    num_vertices: u32,
    flags: u32,
    reserved: [u64; 4],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.PositionF32")]
struct PositionF32([f32; 3]);

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.CorrectionHeader")]
struct CorrectionHeader {
    frame: u64,
    simulated_s: f64,
    dt_s: f64,
    status: u32,
    kind: u32,
    flags: u32,
    num_vertices: u32,
    fault_index: u64,
    fault_value: f64,
    num_edge_face_intersections: u64,
    num_face_pairs: u64,
    contour_length_m: f64,
    num_inside: u64,
    max_displacement_m: f64,
    net_force_n: [f64; 3],
    net_torque_nm: [f64; 3],
    num_pairs: [u32; 16],
    stage_ns: [u64; 8],
    num_skipped_frames: u64,
    reserved: [u64; 5],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.VertexCorrection")]
struct VertexCorrection {
    value: [f32; 3],
    flags: u32,
}

const HELLO: u32 = 1;
const REGISTER: u32 = 2;
const UPDATE_SETTINGS: u32 = 3;
const CLOSE: u32 = 4;
const STATUS: u32 = 5;

fn name(text: &str) -> ServiceName {
    ServiceName::new(text).unwrap()
}

/// Notifies the daemon of an event, known or not.
fn wake(node: &Node<Ipc>, id: usize) {
    let event = node.service_builder(&name("untangled/control")).event().open().unwrap();
    event.notifier_builder().create().unwrap().notify_with_custom_event_id(EventId::new(id)).unwrap();
}

fn request(node: &Node<Ipc>, header: RequestHeader, payload: &[u8]) -> (ReplyHeader, String) {
    let control = node
        .service_builder(&name("untangled/control"))
        .request_response::<[u8], [u8]>()
        .request_user_header::<RequestHeader>()
        .response_user_header::<ReplyHeader>()
        .request_payload_alignment(Alignment::new(64).unwrap())
        .response_payload_alignment(Alignment::new(64).unwrap())
        .open()
        .unwrap();
    let port = control.client_builder().initial_max_slice_len(payload.len().max(1)).create().unwrap();
    let mut request = port.loan_slice_uninit(payload.len()).unwrap();
    *request.user_header_mut() = header;
    let pending = request.write_from_slice(payload).send().unwrap();
    wake(node, 1);
    let mut reply = None;
    eventually("a reply", || {
        reply = pending.receive().unwrap();
        reply.is_some()
    });
    let reply = reply.unwrap();
    (*reply.user_header(), String::from_utf8(reply.payload().to_vec()).unwrap())
}

/// A section table and its sections.
fn sections(sections: &[(u32, Vec<u8>)]) -> (Vec<u8>, u32) {
    let mut table = Vec::new();
    let mut bytes = Vec::new();
    for (id, section) in sections {
        let offset = 24 * sections.len() + bytes.len();
        table.extend(id.to_le_bytes());
        table.extend([0; 4]);
        table.extend((offset as u64).to_le_bytes());
        table.extend((section.len() as u64).to_le_bytes());
        bytes.extend(section);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
    }
    table.extend(bytes);
    (table, u32::try_from(sections.len()).unwrap())
}

fn node(domain: &TestDomain) -> Node<Ipc> {
    let config = domain.0.config().unwrap();
    NodeBuilder::new().config(&config).signal_handling_mode(SignalHandlingMode::Disabled).create().unwrap()
}

/// An upright triangle whose tip stands through a flat one.
const POSITIONS: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.5, 1.0, 2.0], [1.5, 1.0, 2.0], [1.0, 1.1, -1.0]];

/// The ports of a session of 6 vertices.
fn session_ports(node: &Node<Ipc>, reply: &ReplyHeader) -> (States, Corrections) {
    let service = |last: &str| name(&format!("untangled/{:016x}/{}/{last}", reply.instance, reply.session));
    let states = node
        .service_builder(&service("state"))
        .publish_subscribe::<[PositionF32]>()
        .user_header::<StateHeader>()
        .payload_alignment(Alignment::new(64).unwrap())
        .open()
        .unwrap();
    let states = states.publisher_builder().initial_max_slice_len(6).max_loaned_samples(1).create().unwrap();
    let corrections = node
        .service_builder(&service("correction"))
        .publish_subscribe::<[VertexCorrection]>()
        .user_header::<CorrectionHeader>()
        .payload_alignment(Alignment::new(64).unwrap())
        .open()
        .unwrap();
    (states, corrections.subscriber_builder().create().unwrap())
}

/// Sends a frame and checks its correction.
fn exchange_frame(node: &Node<Ipc>, states: &States, corrections: &Corrections, frame: u64) {
    let mut sample = states.loan_slice_uninit(6).unwrap();
    *sample.user_header_mut() =
        StateHeader { frame, simulated_s: 0.5, dt_s: 0.01, num_vertices: 6, ..StateHeader::default() };
    sample.write_from_fn(|vertex| PositionF32(POSITIONS[vertex])).send().unwrap();
    wake(node, 2);
    let mut correction = None;
    eventually("a correction", || {
        correction = corrections.receive().unwrap();
        correction.is_some()
    });
    let correction = correction.unwrap();
    let header = correction.user_header();
    assert_eq!((header.frame, header.status, header.kind, header.num_vertices), (frame, 0, 3, 6));
    assert_eq!((header.num_face_pairs, header.num_inside, header.flags), (1, 1, 0));
    assert_eq!((header.dt_s, header.simulated_s), (0.01, 0.5));
    assert!(header.stage_ns[7] > 0 && header.num_pairs.iter().sum::<u32>() == 1);
    // A client that asks for nothing new reads reserved space as zeros, also where it has got a meaning since.
    assert_eq!(header.reserved, [0; 5]);
    assert_eq!(correction.payload().len(), 6);
    assert_eq!(correction.payload()[5].flags & 3, 3, "inside, and near the path");
}

#[test]
fn client_of_protocol_1_is_served() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let node = node(&domain);
    let ask = |kind, session, payload: &[u8], num_sections| {
        let header = RequestHeader { protocol_version: 1, kind, session, num_sections, ..RequestHeader::default() };
        let (reply, text) = request(&node, header, payload);
        assert_eq!((reply.protocol_version, reply.status), (1, 0), "{text}");
        (reply, text)
    };
    let (_, text) = ask(HELLO, 0, &[], 0);
    let hello: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&hello["protocol_version"], &hello["iceoryx2_version"]), (&1.into(), &"0.10.0".into()));

    let mut params = Vec::new();
    params.extend(6u64.to_le_bytes());
    params.extend(0u32.to_le_bytes());
    params.extend(3u32.to_le_bytes());
    params.extend([0; 16]);
    let triangles = [0u32, 1, 2, 3, 4, 5].iter().flat_map(|index| index.to_le_bytes()).collect();
    let (payload, num_sections) = sections(&[(1, params), (2, triangles)]);
    let (reply, _) = ask(REGISTER, 0, &payload, num_sections);
    let (payload, num_sections) = sections(&[(9, br#"{"stiffness_per_step2": 0.25}"#.to_vec())]);
    ask(UPDATE_SETTINGS, reply.session, &payload, num_sections);

    let (states, corrections) = session_ports(&node, &reply);
    for frame in 1..=3 {
        exchange_frame(&node, &states, &corrections, frame);
    }
    let status: serde_json::Value = serde_json::from_str(&ask(STATUS, 0, &[], 0).1).unwrap();
    assert_eq!((&status["schema"], &status["sessions"][0]["num_frames"]), (&"untangled.status/1".into(), &3.into()));
    ask(CLOSE, reply.session, &[], 0);
}

#[test]
fn client_of_another_protocol_is_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let node = node(&domain);
    for protocol_version in [0, 2, u32::MAX] {
        for kind in [HELLO, REGISTER, UPDATE_SETTINGS, CLOSE, STATUS, 77] {
            let header = RequestHeader { protocol_version, kind, ..RequestHeader::default() };
            let (reply, text) = request(&node, header, &[]);
            assert_eq!((reply.protocol_version, reply.status, reply.session), (1, 1, 0));
            assert!(text.contains(&format!("protocol {protocol_version}")), "{text}");
        }
    }
}

#[test]
fn request_with_unknown_additions_is_accepted() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let node = node(&domain);
    let mut params = Vec::new();
    params.extend(3u64.to_le_bytes());
    params.extend(0u32.to_le_bytes());
    params.extend(3u32.to_le_bytes());
    params.extend([9; 16]);
    let triangles = [0u32, 1, 2].iter().flat_map(|index| index.to_le_bytes()).collect();
    let (payload, num_sections) = sections(&[(1, params), (2, triangles), (1000, vec![1; 77])]);
    let header = RequestHeader {
        protocol_version: 1,
        kind: REGISTER,
        num_sections,
        flags: u32::MAX,
        reserved: [u64::MAX; 5],
        ..RequestHeader::default()
    };
    let (reply, text) = request(&node, header, &payload);
    assert_eq!(reply.status, 0, "{text}");
}
