//! The control server: receives requests.

use std::{sync::Arc, time::Duration};

use iceoryx2::{
    port::server::Server,
    prelude::{AllocationStrategy, Node},
};
use untangled_proto::{
    PROTOCOL_VERSION, PayloadLayout, ReplyHeader, RequestHeader, RequestKind, limits, memory::reply_sample_bytes, names,
};
use untangled_transport::{
    Domain, memory, node as nodes,
    services::{self, Event, Ipc, Requests},
};

use super::{
    registry::Registry,
    reply::{REPLY_BYTES, Replier, Request},
};
use crate::service::{error::ServeError, throttle::Throttle};

type Port = Server<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// Number of replies for which shared memory is committed at the start: two for each client where they are packed, some
/// where they are padded, which takes 64 times as much.
const COMMITTED_REPLIES: u64 = 2 * limits::MAX_CLIENTS as u64;
const COMMITTED_PADDED_REPLIES: u64 = 4;
/// Registrations of more bytes than this are large.
const LARGE_BYTES: usize = 1 << 20;

/// Receives requests, and answers those that take little time. Fields are dropped in order: ports before services.
pub(crate) struct ControlServer {
    /// For clients of this release, and for those of release 0.1.
    inlets: [Inlet; 2],
    replier: Arc<Replier>,
    _event: Event,
}

/// A service for requests and its one server. What is asked for there gets samples of its layout.
struct Inlet {
    server: Port,
    layout: PayloadLayout,
    _service: Requests,
}

/// A request for a worker, since it carries a mesh or asks for one, which may be large.
#[derive(Debug)]
pub(crate) struct MeshRequest {
    request: Request,
    header: RequestHeader,
    layout: PayloadLayout,
    replier: Arc<Replier>,
}

impl ControlServer {
    pub(crate) fn start(node: &Node<Ipc>, registry: Arc<Registry>) -> Result<Self, ServeError> {
        let event = services::create_shared_event(node, names::REPLY)
            .map_err(|error| ServeError::transport("creating the reply event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
        let domain = &registry.options().domain;
        // A client looks for them in this order as well.
        let inlets =
            [Inlet::open(node, domain, PayloadLayout::Packed)?, Inlet::open(node, domain, PayloadLayout::Padded)?];
        Ok(Self { inlets, replier: Arc::new(Replier::new(notifier, registry)), _event: event })
    }

    /// Answers all requests that have come, except for those about a mesh, which are passed to `defer`.
    pub(crate) fn answer(&self, mut defer: impl FnMut(MeshRequest)) {
        for inlet in &self.inlets {
            self.answer_inlet(inlet, &mut defer);
        }
    }

    fn answer_inlet(&self, inlet: &Inlet, defer: &mut impl FnMut(MeshRequest)) {
        loop {
            let request = match inlet.server.receive() {
                Ok(Some(request)) => request,
                Ok(None) => return,
                Err(error) => {
                    static FAILED: Throttle = Throttle::new();
                    if let Some(num_suppressed) = FAILED.admit() {
                        tracing::warn!(?error, num_suppressed, "receiving a request");
                    }
                    return;
                }
            };
            // A copy: the peer may go on writing.
            let header = *request.user_header();
            let (replier, layout) = (&self.replier, inlet.layout);
            let has_mesh = [RequestKind::Register, RequestKind::Observe].map(|kind| kind as u32).contains(&header.kind);
            if has_mesh && header.protocol_version == PROTOCOL_VERSION {
                defer(MeshRequest { request, header, layout, replier: Arc::clone(replier) });
            } else {
                replier.answer(&request, &header, layout);
            }
        }
    }
}

impl MeshRequest {
    /// Whether it may take so long that small sessions must not wait for it.
    pub(crate) fn is_large(&self) -> bool {
        self.request.payload().len() > LARGE_BYTES
    }

    pub(crate) fn run(self) {
        let Self { request, header, layout, replier } = self;
        replier.answer(&request, &header, layout);
    }
}

impl Inlet {
    fn open(node: &Node<Ipc>, domain: &Domain, layout: PayloadLayout) -> Result<Self, ServeError> {
        let (service, server) = create_server(node, layout)?;
        // Refusals must get through where shared memory is full.
        let num_replies = match layout {
            PayloadLayout::Packed => COMMITTED_REPLIES,
            PayloadLayout::Padded => COMMITTED_PADDED_REPLIES,
        };
        let bytes = num_replies * reply_sample_bytes(REPLY_BYTES, layout);
        memory::commit_first(domain, server.id().value(), bytes)
            .map_err(|source| ServeError::System { what: "taking shared memory for replies".to_owned(), source })?;
        Ok(Self { server, layout, _service: service })
    }
}

/// A service for requests with its one server. A server of a daemon that was killed counts until it is cleaned up.
fn create_server(node: &Node<Ipc>, layout: PayloadLayout) -> Result<(Requests, Port), ServeError> {
    const ATTEMPTS: u32 = 20;
    let mut attempt = 0;
    loop {
        attempt += 1;
        let result = services::create_requests(node, layout)
            .map_err(|error| ServeError::transport("creating the service for requests", &error))
            .and_then(|service| {
                let server = service
                    .server_builder()
                    .initial_max_slice_len(REPLY_BYTES)
                    .allocation_strategy(AllocationStrategy::PowerOfTwo)
                    .max_loaned_responses_per_request(1)
                    .create()
                    .map_err(|error| ServeError::transport("creating the server for requests", &error))?;
                Ok((service, server))
            });
        match result {
            Ok(created) => return Ok(created),
            Err(error) if attempt == ATTEMPTS => return Err(error),
            Err(error) => {
                tracing::debug!(%error, attempt, "trying again");
                std::thread::sleep(Duration::from_millis(100));
                nodes::clean_up_dead(node);
            }
        }
    }
}
