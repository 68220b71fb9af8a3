//! Peers that speak iceoryx2 themselves and need not keep to the rules.

use std::time::{Duration, Instant};

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher, subscriber::Subscriber},
    prelude::{EventId, LogLevel, Node, NodeBuilder, SignalHandlingMode, set_log_level},
};
use untangled_proto::{
    CorrectionHeader, PROTOCOL_VERSION, PositionF32, RegisterParams, ReplyHeader, RequestHeader, RequestKind,
    StateHeader, VertexCorrection,
    names::{self, SessionService},
    sections::{SectionWriter, id},
};
use untangled_transport::services::{self, Ipc, Position, Requests};

use super::{PATIENCE, TestDomain};

/// A node of a domain.
pub fn node(domain: &TestDomain) -> Node<Ipc> {
    set_log_level(LogLevel::Fatal);
    NodeBuilder::new()
        .config(&domain.0.config().expect("a domain's name is a path"))
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create()
        .expect("a node")
}

/// The header of a request without a session, in this version of the protocol.
pub fn header(kind: u32, num_sections: u32) -> RequestHeader {
    RequestHeader { protocol_version: PROTOCOL_VERSION, kind, num_sections, ..RequestHeader::default() }
}

/// The name of a session's service in this run of the daemon.
pub fn session_service_name(domain: &TestDomain, session: u64, service: SessionService) -> String {
    let (reply, _) = RawPeer::new(domain).expect_reply(header(RequestKind::Hello as u32, 0), &[]);
    names::session(reply.instance, session, service)
}

/// A peer with ports for requests. Fields are dropped in order.
#[derive(Debug)]
pub struct RawPeer {
    notifier: Notifier<Ipc>,
    requests: Requests,
    node: Node<Ipc>,
}

/// The ports of a session of 3 vertices.
#[derive(Debug)]
pub struct RawSession {
    /// Sends states.
    pub states: Publisher<Ipc, [PositionF32], StateHeader>,
    /// Receives corrections.
    pub corrections: Subscriber<Ipc, [VertexCorrection], CorrectionHeader>,
}

impl RawPeer {
    /// Opens the ports of a domain whose daemon runs.
    pub fn new(domain: &TestDomain) -> Self {
        let node = node(domain);
        let event = services::open_event(&node, names::CONTROL).expect("the daemon made it");
        let requests = services::open_requests(&node).expect("the daemon made it").0;
        Self { notifier: event.notifier_builder().create().expect("there is room for one more"), requests, node }
    }

    /// Sends a request and waits for its reply; none is a lost reply.
    pub fn request(&self, header: RequestHeader, payload: &[u8]) -> Option<(ReplyHeader, Vec<u8>)> {
        let port = self.requests.client_builder().initial_max_slice_len(payload.len().max(1)).create().expect("a port");
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

    /// As [`RawPeer::request`], with the reply's words as text; panics where there is no reply.
    pub fn expect_reply(&self, header: RequestHeader, payload: &[u8]) -> (ReplyHeader, String) {
        let (reply, words) = self.request(header, payload).expect("a reply");
        (reply, String::from_utf8(words).expect("words"))
    }

    /// Registers a session of one face, and makes room for `max_vertices` in its states.
    pub fn session(&self, max_vertices: usize) -> RawSession {
        self.session_with(max_vertices, 0)
    }

    /// As [`RawPeer::session`], with option bits of the registration, but none that make corrections sparse.
    pub fn session_with(&self, max_vertices: usize, options: u32) -> RawSession {
        let params = RegisterParams { num_vertices: 3, precision: 0, correction: 3, ..RegisterParams::default() };
        let mut writer = SectionWriter::default();
        writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]);
        if options != 0 {
            writer.bytes(id::OPTIONS, options.to_le_bytes().to_vec());
        }
        let (payload, num_sections) = writer.finish();
        let (reply, _) = self.request(header(RequestKind::Register as u32, num_sections), &payload).expect("a reply");
        assert_eq!(reply.status, 0);
        let name = |service| names::session(reply.instance, reply.session, service);
        let corrections =
            services::open_corrections(&self.node, &name(SessionService::Correction)).expect("it is there");
        let states = PositionF32::open_states(&self.node, &name(SessionService::State)).expect("it is there");
        RawSession {
            corrections: corrections.subscriber_builder().create().expect("a port"),
            states: states.publisher_builder().initial_max_slice_len(max_vertices).create().expect("a port"),
        }
    }

    /// Notifies the daemon. A daemon that is too busy to take it in looks anyway.
    pub fn wake(&self, event: usize) {
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
