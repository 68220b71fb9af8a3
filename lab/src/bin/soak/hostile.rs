//! Peers that don't keep to the rules, over shared memory: each request and each frame gets one answer, and others don't notice.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher, subscriber::Subscriber},
    prelude::{EventId, Node, NodeBuilder, SignalHandlingMode},
};
use rand::{RngExt, SeedableRng, rngs::StdRng};
use rustix::process::Signal;
use untangled_proto::{CorrectionHeader, PROTOCOL_VERSION, PositionF32, RegisterParams, ReplyHeader, RequestHeader, RequestKind, StateHeader, Status, VertexCorrection, names::{self, SessionService}, sections::{SectionWriter, id}};
use untangled_transport::services::{self, Control, Ipc};

use super::{
    faults::{Row, Witness},
    processes::{Daemon, PATIENCE, Programs, TestDomain},
};

/// A peer that speaks iceoryx2 itself. Fields are dropped in order.
pub struct RawPeer {
    notifier: Notifier<Ipc>,
    control: Control,
    node: Node<Ipc>,
}

/// The ports of a raw session of 3 vertices.
pub struct RawSession {
    pub states: Publisher<Ipc, [PositionF32], StateHeader>,
    pub corrections: Subscriber<Ipc, [VertexCorrection], CorrectionHeader>,
}

impl RawPeer {
    pub fn new(domain: &TestDomain) -> Self {
        let node = NodeBuilder::new()
            .config(&domain.0.config().expect("a domain's name is a path"))
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create()
            .expect("a node");
        let event = services::open_event(&node, names::CONTROL).expect("the daemon made it");
        let control = services::open_control(&node).expect("the daemon made it");
        Self { notifier: event.notifier_builder().create().expect("there is room for one more"), control, node }
    }

    /// Sends a request and waits for its reply; none is a lost reply.
    pub fn request(&self, header: RequestHeader, payload: &[u8]) -> Option<(ReplyHeader, Vec<u8>)> {
        let port = self.control.client_builder().initial_max_slice_len(payload.len().max(1)).create().expect("a port");
        let mut request = port.loan_slice_uninit(payload.len()).expect("a loan");
        *request.user_header_mut() = header;
        let pending = request.write_from_slice(payload).send().expect("a server");
        self.wake(names::EVENT_REQUEST);
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Some(reply) = pending.receive().expect("a reply or none") {
                return Some((*reply.user_header(), reply.payload().to_vec()));
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        None
    }

    /// Registers a session of one face.
    pub fn session(&self, max_vertices: usize) -> RawSession {
        let params = RegisterParams { num_vertices: 3, precision: 0, correction: 3, ..RegisterParams::default() };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]);
        let (payload, num_sections) = writer.finish();
        let (reply, _) = self.request(header(RequestKind::Register as u32, num_sections), &payload).expect("a reply");
        assert_eq!(reply.status, 0);
        let name = |service| names::session(reply.instance, reply.session, service);
        let corrections =
            services::open_corrections(&self.node, &name(SessionService::Correction)).expect("it is there");
        let states =
            services::open_states::<PositionF32>(&self.node, &name(SessionService::State)).expect("it is there");
        RawSession {
            corrections: corrections.subscriber_builder().create().expect("a port"),
            states: states.publisher_builder().initial_max_slice_len(max_vertices).create().expect("a port"),
        }
    }

    pub fn wake(&self, event: usize) {
        // A daemon that is too busy to take it in looks anyway.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(event));
    }

    /// Waits for the correction of a frame, and gives its header and values; none is a lost answer.
    pub fn answer(&self, session: &RawSession, frame: u64) -> Option<(CorrectionHeader, Vec<VertexCorrection>)> {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            while let Some(sample) = session.corrections.receive().expect("a sample or none") {
                if sample.user_header().frame == frame {
                    return Some((*sample.user_header(), sample.payload().to_vec()));
                }
            }
            std::thread::sleep(Duration::from_micros(100));
        }
        None
    }
}

pub fn header(kind: u32, num_sections: u32) -> RequestHeader {
    RequestHeader { protocol_version: PROTOCOL_VERSION, kind, num_sections, ..RequestHeader::default() }
}

fn bystanders(programs: Programs) -> (TestDomain, Daemon, Witness) {
    let domain = TestDomain::new();
    let daemon = Daemon::start(programs, &domain, &[]);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    witness.wait_for_frame();
    (domain, daemon, witness)
}

fn finish(domain: &TestDomain, mut daemon: Daemon, witness: Witness, row: &mut Row) {
    witness.wait_for_frame();
    witness.finish(row);
    assert!(daemon.is_running(), "the daemon lives");
    assert!(daemon.stop(Signal::TERM).success());
    assert_eq!(domain.shared_memory().0, 0);
}

/// A float of any kind, often one that hurts.
fn wild(rng: &mut StdRng) -> f64 {
    let special =
        [0.0, -0.0, f64::NAN, f64::INFINITY, -f64::INFINITY, f64::MIN_POSITIVE, f64::MAX, 1e-300, 1e-9, 1e9, 1.0];
    match rng.random_range(0..3) {
        0 => special[rng.random_range(0..special.len())],
        1 => f64::from_bits(rng.random()),
        _ => rng.random_range(-2.0..2.0),
    }
}

/// Frames whose headers and lengths lie.
pub fn lying_headers(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "frame whose header or length lies".into(), num_tries, ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    let session = peer.session(64);
    let mut num_accepted = 0;
    for frame in 1..=num_tries {
        let length = if rng.random_bool(0.5) { 3 } else { rng.random_range(0..=64) };
        let honest = rng.random_bool(0.3);
        let mut sample = session.states.loan_slice_uninit(length).expect("a loan");
        *sample.user_header_mut() = StateHeader {
            frame,
            simulated_s: if honest { 1.0 } else { wild(&mut rng) },
            dt_s: if honest { 0.01 } else { wild(&mut rng) },
            num_vertices: if rng.random_bool(0.7) { 3 } else { rng.random() },
            flags: rng.random(),
            reserved: rng.random(),
        };
        let sample = sample.write_from_fn(|_| PositionF32(std::array::from_fn(|_| wild(&mut rng) as f32)));
        let (sent, honest_length) = (*sample.user_header(), sample.payload().len() == 3);
        let finite = sample.payload().iter().flat_map(|position| position.0).all(f32::is_finite);
        sample.send().expect("a subscriber");
        peer.wake(names::EVENT_STATE);
        let Some((answer, values)) = peer.answer(&session, frame) else {
            row.num_lost += 1;
            continue;
        };
        let usable = honest_length
            && finite
            && sent.num_vertices == 3
            && (1e-9..=1e9).contains(&sent.dt_s)
            && sent.simulated_s.is_finite();
        let zeros = values.iter().all(|vertex| *vertex == VertexCorrection::default());
        let right = match Status::from_code(answer.status) {
            Some(Status::Ok) => usable && values.len() == 3,
            Some(Status::BadHeader | Status::BadPosition) => !usable && zeros,
            _ => false,
        };
        num_accepted += u64::from(answer.status == 0);
        row.num_frames += 1;
        row.num_wrong += u64::from(!right);
    }
    row.note = format!("{num_accepted} could be used and were, the others were refused with a status");
    drop((session, peer));
    finish(&domain, daemon, witness, &mut row);
    row
}

/// A client that goes on writing into samples that it has sent.
pub fn writing_after_sending(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "sample written to after it was sent".into(), num_tries, ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    let session = peer.session(3);
    let mut num_refused = 0;
    for frame in 1..=num_tries {
        let mut sample = session.states.loan_slice_uninit(3).expect("a loan");
        let memory = sample.payload_mut().as_mut_ptr().cast::<f32>() as usize;
        *sample.user_header_mut() = StateHeader { frame, dt_s: 0.01, num_vertices: 3, ..StateHeader::default() };
        let header = std::ptr::from_mut(sample.user_header_mut()) as usize;
        sample.write_from_fn(|k| PositionF32([k as f32, (k * k) as f32, 0.0])).send().expect("a subscriber");
        let done = AtomicBool::new(false);
        let garbage: [u32; 9] = std::array::from_fn(|_| (wild(&mut rng) as f32).to_bits());
        let answer = std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    for (k, bits) in garbage.iter().enumerate() {
                        // SAFETY: the sample's memory stays mapped while the port lives. That the daemon reads it meanwhile is the point.
                        unsafe { (memory as *mut u32).add(k).write_volatile(*bits) };
                    }
                    // SAFETY: as above; the number of vertices is the header's fourth field.
                    unsafe { (header as *mut u32).add(6).write_volatile(garbage[0]) };
                    std::hint::spin_loop();
                }
            });
            peer.wake(names::EVENT_STATE);
            let answer = peer.answer(&session, frame);
            done.store(true, Ordering::Relaxed);
            answer
        });
        let Some((answer, values)) = answer else {
            row.num_lost += 1;
            continue;
        };
        row.num_frames += 1;
        num_refused += u64::from(answer.status != 0);
        let right =
            matches!(Status::from_code(answer.status), Some(Status::Ok | Status::BadPosition | Status::BadHeader));
        let finite = values.iter().flat_map(|vertex| vertex.value).all(f32::is_finite);
        row.num_wrong += u64::from(!right || !finite || values.len() != 3);
    }
    row.note = format!("{num_refused} refused, the others answered with finite numbers");
    drop((session, peer));
    finish(&domain, daemon, witness, &mut row);
    row
}

/// Every field of every request at its limits and beyond them, and text that is none.
pub fn request_limits(programs: Programs) -> Row {
    let mut row = Row { what: "request with a field at its limits or beyond".into(), ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    for (header, payload) in limit_cases() {
        row.num_tries += 1;
        let Some((reply, text)) = peer.request(header, &payload) else {
            row.num_lost += 1;
            continue;
        };
        let known = Status::from_code(reply.status).is_some_and(|status| status != Status::Internal);
        let in_words = reply.status == 0 || !text.is_empty();
        if !known || !in_words || reply.token != header.token || std::str::from_utf8(&text).is_err() {
            eprintln!("{header:?}: {reply:?} {}", String::from_utf8_lossy(&text));
            row.num_wrong += 1;
        }
        if reply.status == 0 && header.kind == RequestKind::Register as u32 {
            let close = RequestHeader { session: reply.session, ..self::header(RequestKind::Close as u32, 0) };
            row.num_lost += u64::from(peer.request(close, &[]).is_none_or(|(reply, _)| reply.status != 0));
        }
    }
    row.note = "each got one reply, a refusal in words where it was due".into();
    drop(peer);
    finish(&domain, daemon, witness, &mut row);
    row
}

/// A valid registration with one section in place of its own; no bytes leave the section out.
fn registration_with(section: u32, bytes: Option<Vec<u8>>) -> (Vec<u8>, u32) {
    let params = RegisterParams { num_vertices: 3, precision: 0, correction: 0, ..RegisterParams::default() };
    let floats = |count: usize| vec![0.5f64; count].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let indices = |values: &[u32]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let valid = [
        (id::PARAMS, params.to_bytes().to_vec()),
        (id::TRIANGLES, indices(&[0, 1, 2])),
        (id::UV_COORDINATES, [0.0f64, 0.0, 1.0, 0.0, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect()),
        (id::UV_CORNERS, indices(&[0, 1, 2])),
        (
            id::REST_POSITIONS,
            [0.0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect(),
        ),
        (id::MASSES, floats(3)),
        (id::PINS, indices(&[2])),
        (id::LAYERS, indices(&[0, 0, 1])),
        (id::SETTINGS, b"{}".to_vec()),
        (77, vec![1, 2, 3]),
    ];
    let mut writer = SectionWriter::default();
    for (id, content) in valid {
        match (id == section, &bytes) {
            (false, _) => drop(writer.bytes(id, content)),
            (true, Some(bytes)) => drop(writer.bytes(id, bytes.clone())),
            (true, None) => {}
        }
    }
    writer.finish()
}

fn limit_cases() -> Vec<(RequestHeader, Vec<u8>)> {
    let mut cases = Vec::new();
    let (register, update) = (RequestKind::Register as u32, RequestKind::UpdateSettings as u32);
    let (valid, num_sections) = registration_with(0, None);
    let good = header(register, num_sections);
    let mut header_case = |header| cases.push((header, valid.clone()));
    for value in [0, 1, 2, u32::MAX - 1, u32::MAX] {
        header_case(RequestHeader { protocol_version: value, ..good });
        header_case(RequestHeader { flags: value, ..good });
        header_case(RequestHeader { token: [u64::from(value); 2], ..good });
        header_case(RequestHeader { reserved: [u64::from(value); 3], ..good });
    }
    for kind in (0..8).chain([u32::MAX]) {
        // None that lives: whoever asks to close a session is believed.
        for session in [0, 1 << 40, u64::MAX] {
            header_case(RequestHeader { kind, session, ..good });
        }
    }
    for num_sections in [0, 1, 9, 10, 11, 32, 33, 1 << 31, u32::MAX] {
        header_case(RequestHeader { num_sections, ..good });
    }
    // The table: each word of each of its first entries.
    for entry in 0..3 {
        for (at, width) in [(0, 4), (4, 4), (8, 8), (16, 8)] {
            for value in [0u64, 1, 7, 8, 9, 24, valid.len() as u64, 1 << 31, 1 << 63, u64::MAX] {
                let mut payload = valid.clone();
                payload[24 * entry + at..][..width].copy_from_slice(&value.to_le_bytes()[..width]);
                cases.push((good, payload));
            }
        }
    }
    for length in [0, 1, 23, 24, 239, 240, valid.len() - 1] {
        cases.push((good, valid[..length].to_vec()));
    }
    let mut section_case = |section, bytes: Option<Vec<u8>>| {
        let (payload, num_sections) = registration_with(section, bytes);
        cases.push((header(register, num_sections), payload));
    };
    for num_vertices in [0, 1, 2, 3, 4, 1 << 24, (1 << 24) + 1, 1 << 32, u64::MAX] {
        for precision in [0, 1, 2, u32::MAX] {
            let params = RegisterParams { num_vertices, precision, correction: 3, ..RegisterParams::default() };
            section_case(id::PARAMS, Some(params.to_bytes().to_vec()));
        }
    }
    for correction in [0, 1, 2, 3, 4, u32::MAX] {
        let params = RegisterParams { num_vertices: 3, precision: 0, correction, ..RegisterParams::default() };
        section_case(id::PARAMS, Some(params.to_bytes().to_vec()));
    }
    for section in 1..=9 {
        section_case(section, None);
        for length in [0, 1, 3, 4, 8, 11, 12, 16, 23, 24, 31, 33, 48, 72, 100] {
            section_case(section, Some(vec![0; length]));
            section_case(section, Some(vec![255; length]));
        }
    }
    for section in [id::UV_COORDINATES, id::REST_POSITIONS, id::MASSES] {
        for value in [f64::NAN, f64::INFINITY, -1.0, f64::MAX, f64::MIN_POSITIVE, 1e300] {
            let count = match section {
                id::REST_POSITIONS => 9,
                id::UV_COORDINATES => 6,
                _ => 3,
            };
            section_case(section, Some(vec![value; count].iter().flat_map(|x| x.to_le_bytes()).collect()));
        }
    }
    for document in documents() {
        section_case(id::SETTINGS, Some(document));
    }
    for document in documents() {
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        // None that lives: whoever asks to close a session is believed.
        for session in [0, 1 << 40, u64::MAX] {
            cases.push((RequestHeader { session, ..header(update, num_sections) }, payload.clone()));
        }
    }
    cases
}

/// Settings documents: values at and beyond limits, and bytes that are no text.
fn documents() -> Vec<Vec<u8>> {
    let mut documents = vec![
        vec![0xff, 0xfe, 0x00],
        b"{\"\xc3\x28\": 1}".to_vec(),
        b"{\"response\": \"\xf0\x9f\"}".to_vec(),
        b"{\"\\ud800\": 1}".to_vec(),
        vec![b' '; 1 << 20],
        vec![b' '; (1 << 20) + 1],
        [vec![b'['; 100_000], vec![b']'; 100_000]].concat(),
        format!("{{\"{}\": 1}}", "x".repeat(100_000)).into_bytes(),
        [b"{\"response\": \"".to_vec(), "\u{1F455}".repeat(50_000).into_bytes(), b"\"}".to_vec()].concat(),
    ];
    let numbers = [
        "0",
        "-1",
        "1",
        "3",
        "1000",
        "1001",
        "1e400",
        "-1e400",
        "1e-400",
        "18446744073709551616",
        "NaN",
        "null",
        "\"1\"",
        "[]",
        "{}",
        "true",
    ];
    for name in [
        "quality",
        "response",
        "inside",
        "layer_order",
        "winding",
        "pinned_outside",
        "stiffness_per_step2",
        "max_step_edge_lengths",
        "thickness_m",
        "min_centres",
        "max_centres",
        "path_rings",
        "deadline_us",
        "unknown",
        "",
    ] {
        documents.extend(numbers.iter().map(|number| format!("{{\"{name}\": {number}}}").into_bytes()));
    }
    documents
}
