//! The host end's place in the local domain: what a client finds there as long as a daemon serves somewhere.

use std::time::Duration;

use iceoryx2::{
    active_request::ActiveRequest,
    port::{listener::Listener, server::Server},
    prelude::{AllocationStrategy, Node},
};
use untangled_proto::{PayloadLayout, ReplyHeader, RequestHeader, limits, memory::reply_sample_bytes, names};
use untangled_transport::{
    Domain, memory, node as nodes,
    services::{self, Event, Ipc, Requests},
};

use crate::error::BridgeError;

/// A request that has not been replied to.
pub(crate) type Pending = ActiveRequest<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// Room for a reply at the start, as in a daemon.
pub(crate) const REPLY_BYTES: usize = 2048;
/// Number of replies for which shared memory is committed, as in a daemon.
const COMMITTED_REPLIES: u64 = 2 * limits::MAX_CLIENTS as u64;
const COMMITTED_PADDED_REPLIES: u64 = 4;

/// The event by which clients wake this process.
#[derive(Debug)]
pub(super) struct Doorbell {
    listener: Listener<Ipc>,
    _event: Event,
}

impl Doorbell {
    pub(super) fn new(node: &Node<Ipc>) -> Result<Self, BridgeError> {
        let event = services::create_shared_event(node, names::CONTROL)
            .map_err(|error| BridgeError::transport("creating the control event", &error))?;
        let listener =
            event.listener_builder().create().map_err(|error| BridgeError::transport("creating a listener", &error))?;
        Ok(Self { listener, _event: event })
    }

    /// Sleeps until an event comes, at most for `wait`; whether one came.
    pub(super) fn wait(&self, wait: Duration) -> bool {
        // An interrupted wait is a shorter one.
        self.listener.timed_wait(|_| {}, wait).is_ok_and(|num_events| num_events > 0)
    }
}

/// A service for requests and its one server.
#[derive(Debug)]
pub(super) struct Inlet {
    server: Server<Ipc, [u8], RequestHeader, [u8], ReplyHeader>,
    layout: PayloadLayout,
    _service: Requests,
}

impl Inlet {
    /// Those for clients of this release and of release 0.1, in the order in which a client looks for them.
    pub(super) fn open_all(node: &Node<Ipc>, domain: &Domain) -> Result<Vec<Self>, BridgeError> {
        [PayloadLayout::Packed, PayloadLayout::Padded]
            .into_iter()
            .map(|layout| Self::open(node, domain, layout))
            .collect()
    }

    fn open(node: &Node<Ipc>, domain: &Domain, layout: PayloadLayout) -> Result<Self, BridgeError> {
        const ATTEMPTS: u32 = 20;
        let mut attempt = 0;
        let inlet = loop {
            attempt += 1;
            match Self::try_open(node, layout) {
                Ok(inlet) => break inlet,
                Err(error) if attempt == ATTEMPTS => return Err(error),
                Err(error) => {
                    // A server of a process that was killed counts until it is cleaned up.
                    tracing::debug!(%error, attempt, "trying again");
                    std::thread::sleep(Duration::from_millis(100));
                    nodes::clean_up_dead(node);
                }
            }
        };
        let num_replies = match layout {
            PayloadLayout::Packed => COMMITTED_REPLIES,
            PayloadLayout::Padded => COMMITTED_PADDED_REPLIES,
        };
        // Refusals must get through where shared memory is full.
        let bytes = num_replies * reply_sample_bytes(REPLY_BYTES, layout);
        memory::commit_first(domain, inlet.server.id().value(), bytes)
            .map_err(|source| BridgeError::System { what: "taking shared memory for replies".to_owned(), source })?;
        Ok(inlet)
    }

    fn try_open(node: &Node<Ipc>, layout: PayloadLayout) -> Result<Self, BridgeError> {
        let service = services::create_requests(node, layout)
            .map_err(|error| BridgeError::transport("creating the service for requests", &error))?;
        let server = service
            .server_builder()
            .initial_max_slice_len(REPLY_BYTES)
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .max_loaned_responses_per_request(1)
            .create()
            .map_err(|error| BridgeError::transport("creating the server for requests", &error))?;
        Ok(Self { server, layout, _service: service })
    }

    pub(super) fn layout(&self) -> PayloadLayout {
        self.layout
    }

    /// The next request that has come.
    pub(super) fn receive(&self) -> Option<Pending> {
        self.server.receive().unwrap_or_else(|error| {
            tracing::debug!(?error, "receiving a request");
            None
        })
    }
}
