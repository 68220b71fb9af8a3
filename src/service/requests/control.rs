//! The control server: receives requests.

use std::{sync::Arc, time::Duration};

use iceoryx2::{
    port::server::Server,
    prelude::{AllocationStrategy, Node},
};
use untangled_proto::{PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, limits, names};
use untangled_transport::{
    memory, node as nodes,
    services::{self, Control, Event, Ipc},
};

use super::{
    registry::Registry,
    reply::{REPLY_BYTES, Replier, Request},
};
use crate::service::{error::ServeError, throttle::Throttle};

type Port = Server<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// Number of replies for which shared memory is committed at the start: two for each client.
const COMMITTED_REPLIES: u64 = 2 * limits::MAX_CLIENTS as u64;
/// Registrations of more bytes than this are large.
const LARGE_BYTES: usize = 1 << 20;

/// Receives requests, and answers those that take little time. Fields are dropped in order: ports before services.
pub(crate) struct ControlServer {
    server: Port,
    replier: Arc<Replier>,
    _service: Control,
    _event: Event,
}

/// A registration, for a worker: a mesh may be large.
#[derive(Debug)]
pub(crate) struct RegistrationJob {
    request: Request,
    header: RequestHeader,
    replier: Arc<Replier>,
}

impl ControlServer {
    pub(crate) fn start(node: &Node<Ipc>, registry: Arc<Registry>) -> Result<Self, ServeError> {
        let event = services::create_shared_event(node, names::REPLY)
            .map_err(|error| ServeError::transport("creating the reply event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
        let (service, server) = create_server(node)?;
        // Refusals must get through where shared memory is full.
        let domain = &registry.options().domain;
        memory::commit_first(domain, server.id().value(), COMMITTED_REPLIES * REPLY_BYTES as u64)
            .map_err(|source| ServeError::System { what: "taking shared memory for replies", source })?;
        Ok(Self { server, replier: Arc::new(Replier::new(notifier, registry)), _service: service, _event: event })
    }

    /// Answers all requests that have come, except for registrations, which are passed to `defer`.
    pub(crate) fn answer(&self, mut defer: impl FnMut(RegistrationJob)) {
        loop {
            let request = match self.server.receive() {
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
            let replier = &self.replier;
            if header.kind == RequestKind::Register as u32 && header.protocol_version == PROTOCOL_VERSION {
                defer(RegistrationJob { request, header, replier: Arc::clone(replier) });
            } else {
                replier.answer(&request, &header);
            }
        }
    }
}

impl RegistrationJob {
    /// Whether reading it may take so long that small sessions must not wait for it.
    pub(crate) fn is_large(&self) -> bool {
        self.request.payload().len() > LARGE_BYTES
    }

    pub(crate) fn run(self) {
        let Self { request, header, replier } = self;
        replier.register(&request, &header);
    }
}

/// The control service with its one server. A server of a daemon that was killed counts until it is cleaned up.
fn create_server(node: &Node<Ipc>) -> Result<(Control, Port), ServeError> {
    const ATTEMPTS: u32 = 20;
    let mut attempt = 0;
    loop {
        attempt += 1;
        let result = services::create_control(node)
            .map_err(|error| ServeError::transport("creating the control service", &error))
            .and_then(|service| {
                let server = service
                    .server_builder()
                    .initial_max_slice_len(REPLY_BYTES)
                    .allocation_strategy(AllocationStrategy::PowerOfTwo)
                    .max_loaned_responses_per_request(1)
                    .create()
                    .map_err(|error| ServeError::transport("creating the control server", &error))?;
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
