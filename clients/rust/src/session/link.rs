//! The ports of a registered session.

use std::{sync::Arc, time::Instant};

use iceoryx2::{
    port::{listener::Listener, publisher::Publisher},
    prelude::Node,
};
use untangled_proto::{
    PayloadLayout, PositionF32, PositionF64, Precision, StateHeader,
    names::{self, SessionService},
};
use untangled_transport::{
    Domain,
    services::{self, Ipc, Position},
};

use super::{paths::PathsPort, repair::RepairPort, samples::CorrectionPort};
use crate::{
    control::{Reply, SLICE, check_memory, commit_memory},
    error::RequestError,
    registration::Registration,
};

/// Publishes states, in the precision of the session.
#[derive(Debug)]
pub(crate) enum StatePort {
    F32(Publisher<Ipc, [PositionF32], StateHeader>),
    F64(Publisher<Ipc, [PositionF64], StateHeader>),
}

/// The ports of a session that the daemon knows.
#[derive(Debug)]
pub(crate) struct Link {
    pub(crate) session: u64,
    /// Vertices that became one with another.
    pub(crate) num_welded: usize,
    pub(crate) states: Arc<StatePort>,
    pub(crate) corrections: CorrectionPort,
    pub(crate) listener: Listener<Ipc>,
    pub(crate) paths: Option<PathsPort>,
    pub(crate) repairs: Option<RepairPort>,
    pub(crate) opened: Instant,
    /// When the daemon's process was last checked.
    pub(crate) checked: Instant,
}

impl Link {
    /// Opens the services that a registration's reply names.
    pub(crate) fn open(
        node: &Node<Ipc>,
        domain: &Domain,
        reply: &Reply,
        registration: &Registration,
        layout: PayloadLayout,
    ) -> Result<Self, RequestError> {
        if !registration.body.is_empty() && reply.header.num_body_vertices == 0 {
            // The session ends by itself: nobody takes it up.
            return Err(RequestError::too_old("bodies", "`body`"));
        }
        if registration.weld && reply.header.num_places == 0 && registration.num_vertices > 0 {
            return Err(RequestError::too_old("welding", "`weld`"));
        }
        let needed = registration.state_segment_bytes(layout);
        check_memory(needed)?;
        let session = reply.header.session;
        let name = |service| names::session(reply.header.instance, session, service);
        let corrections = CorrectionPort::open(node, name, registration.options())?;
        let listener = services::open_event(node, &name(SessionService::Event))
            .map_err(|error| RequestError::transport("opening the session's event", &error))?
            .listener_builder()
            .create()
            .map_err(|error| RequestError::transport("creating a listener", &error))?;
        let paths = match registration.paths {
            true => Some(PathsPort::open(node, &name(SessionService::Paths))?),
            false => None,
        };
        let repairs = match registration.repairs {
            true => RepairPort::open(node, &name(SessionService::Repair), registration.precision)?,
            false => None,
        };
        let states = name(SessionService::State);
        let states = match registration.precision {
            Precision::F32 => StatePort::F32(publisher(node, &states, registration.num_vertices)?),
            Precision::F64 => StatePort::F64(publisher(node, &states, registration.num_vertices)?),
        };
        let port_id = match &states {
            StatePort::F32(publisher) => publisher.id().value(),
            StatePort::F64(publisher) => publisher.id().value(),
        };
        commit_memory(domain, port_id, needed)?;
        let states = Arc::new(states);
        let opened = Instant::now();
        let num_places = usize::try_from(reply.header.num_places).unwrap_or(usize::MAX);
        let num_welded = if registration.weld { registration.num_vertices.saturating_sub(num_places) } else { 0 };
        Ok(Self { session, num_welded, states, corrections, listener, paths, repairs, opened, checked: opened })
    }

    /// Whether the daemon has closed its side, or was cleaned up after a crash. Reads shared memory only.
    pub(crate) fn is_closed(&self) -> bool {
        !self.corrections.has_publisher()
    }

    /// Whether the daemon has closed its side or its process is gone. Asks the system only if nothing has come for a
    /// while.
    pub(crate) fn is_gone(&mut self) -> bool {
        self.is_closed() || (self.checked.elapsed() >= SLICE && self.is_dead())
    }

    /// Whether the daemon's process is gone. Costs system calls, so it is called only while nothing comes.
    pub(crate) fn is_dead(&mut self) -> bool {
        self.checked = Instant::now();
        self.corrections.has_dead_user() || self.is_closed()
    }
}

fn publisher<P: Position>(
    node: &Node<Ipc>,
    name: &str,
    num_vertices: usize,
) -> Result<Publisher<Ipc, [P], StateHeader>, RequestError> {
    P::open_states(node, name)
        .map_err(|error| RequestError::transport("opening the state service", &error))?
        .publisher_builder()
        .initial_max_slice_len(num_vertices)
        .max_loaned_samples(1)
        .create()
        .map_err(|error| RequestError::transport("creating a publisher", &error))
}
