//! What the threads of a host end share.

use std::{
    collections::hash_map::RandomState,
    hash::BuildHasher,
    sync::{
        Arc,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::Instant,
};

use iceoryx2::{port::notifier::Notifier, prelude::Node};
use untangled_proto::{PROTOCOL_VERSION, RequestHeader, RequestKind};
use untangled_transport::{
    Domain,
    services::{Event, Ipc},
};
use zenoh::Wait;

use super::{directory::Directory, session::Remote, sessions::Sessions};
use crate::{
    metrics::Metrics,
    net::Urgency,
    wire::{keys, request::Request},
};

/// What the threads of a host end share. Fields are dropped in order: ports before services before the node.
pub(crate) struct Shared {
    pub(crate) sessions: Sessions,
    pub(crate) directory: Directory,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) name: String,
    /// Longest message to a daemon end.
    pub(crate) max_message_bytes: usize,
    pub(crate) domain: Domain,
    pub(crate) instance: u64,
    pub(crate) run: u64,
    pub(crate) num_registered: AtomicU64,
    pub(crate) num_requests: AtomicUsize,
    /// How often the servers for requests were opened or closed.
    pub(crate) num_openings: AtomicU64,
    pub(crate) random: RandomState,
    pub(crate) network: zenoh::Session,
    pub(crate) reply_notifier: Notifier<Ipc>,
    pub(crate) _reply_event: Event,
    pub(crate) node: Arc<Node<Ipc>>,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Shared {
    /// A link that no other registration has.
    pub(crate) fn new_link(&self) -> u64 {
        self.random.hash_one((self.run, self.num_registered.load(Ordering::Relaxed), Instant::now()))
    }

    /// Asks a daemon end to close a session; nobody waits for the reply.
    pub(crate) fn close(&self, link: u64, remote: &Remote) {
        let header = RequestHeader {
            protocol_version: PROTOCOL_VERSION,
            kind: RequestKind::Close as u32,
            session: remote.session,
            ..RequestHeader::default()
        };
        let request = Request { link, header, payload: &[] };
        let asked = self
            .network
            .get(keys::requests(&remote.daemon, &self.name))
            .payload(request.to_bytes())
            .priority(Urgency::Data.priority())
            .callback(|_| {})
            .wait();
        if let Err(error) = asked {
            tracing::debug!(%error, "closing a session");
        }
    }
}
