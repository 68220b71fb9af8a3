//! What the ports of a session are opened by.

use iceoryx2::{port::listener::Listener, prelude::Node};
use untangled_client::RequestError;
use untangled_proto::{
    Precision, RegisterParams,
    names::{self, SessionService},
    sections::{Sections, id},
};
use untangled_transport::services::{self, Ipc};

/// A session, as its registration and the reply say.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Shape {
    pub(in super::super) instance: u64,
    pub(in super::super) session: u64,
    pub(in super::super) num_vertices: usize,
    pub(in super::super) precision: Precision,
}

impl Shape {
    /// That of a registration which the daemon has accepted: nothing of it is checked again but what is read here.
    pub(in super::super) fn read(payload: &[u8], num_sections: u32, [instance, session]: [u64; 2]) -> Option<Self> {
        let sections = Sections::parse(payload, usize::try_from(num_sections).ok()?).ok()?;
        let params = sections.bytes(id::PARAMS).and_then(RegisterParams::from_bytes)?;
        Some(Self {
            instance,
            session,
            num_vertices: usize::try_from(params.num_vertices).ok()?,
            precision: Precision::from_code(params.precision)?,
        })
    }

    pub(in super::super) fn name(&self, service: SessionService) -> String {
        names::session(self.instance, self.session, service)
    }
}

/// A listener of the session's event.
pub(in super::super) fn listener(node: &Node<Ipc>, shape: &Shape) -> Result<Listener<Ipc>, RequestError> {
    services::open_event(node, &shape.name(SessionService::Event))
        .map_err(|error| failed("opening the session's event", &error))?
        .listener_builder()
        .create()
        .map_err(|error| failed("creating a listener", &error))
}

pub(super) fn failed(what: &'static str, reason: &dyn std::fmt::Debug) -> RequestError {
    RequestError::Transport { what, reason: format!("{reason:?}") }
}
