//! Hands states to the daemon.

use iceoryx2::port::publisher::Publisher;
use untangled_client::{
    RequestError,
    control::{Connection, check_memory, commit_memory},
};
use untangled_proto::{PositionF32, PositionF64, Precision, StateHeader, memory, names::SessionService};
use untangled_transport::services::{Ipc, Position};

use super::shape::{Shape, failed};
use crate::wire::plain::{self, Plain};

/// Hands states to the daemon, in the precision of the session.
#[derive(Debug)]
pub(in super::super) enum StatePort {
    F32(Publisher<Ipc, [PositionF32], StateHeader>),
    F64(Publisher<Ipc, [PositionF64], StateHeader>),
}

/// Why a state was not handed on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in super::super) enum StateError {
    /// It is shorter than its header, longer than the session's states, or ends within a position.
    Malformed,
    /// iceoryx2 reports this.
    Transport(String),
}

impl StatePort {
    pub(in super::super) fn open(connection: &Connection, shape: &Shape) -> Result<Self, RequestError> {
        let needed = memory::state_segment_bytes(shape.num_vertices, shape.precision, connection.layout());
        check_memory(needed)?;
        let port = match shape.precision {
            Precision::F32 => Self::F32(publisher(connection, shape)?),
            Precision::F64 => Self::F64(publisher(connection, shape)?),
        };
        let id = match &port {
            Self::F32(publisher) => publisher.id().value(),
            Self::F64(publisher) => publisher.id().value(),
        };
        commit_memory(connection.domain(), id, needed)?;
        Ok(port)
    }

    /// Hands on a header and positions.
    pub(in super::super) fn send(&self, body: &[u8]) -> Result<(), StateError> {
        match self {
            Self::F32(publisher) => send(publisher, body),
            Self::F64(publisher) => send(publisher, body),
        }
    }
}

fn publisher<P: Position>(
    connection: &Connection,
    shape: &Shape,
) -> Result<Publisher<Ipc, [P], StateHeader>, RequestError> {
    P::open_states(connection.node(), &shape.name(SessionService::State))
        .map_err(|error| failed("opening the state service", &error))?
        .publisher_builder()
        .initial_max_slice_len(shape.num_vertices)
        .max_loaned_samples(1)
        .create()
        .map_err(|error| failed("creating a publisher", &error))
}

fn send<P: Position + Plain + Default>(
    publisher: &Publisher<Ipc, [P], StateHeader>,
    body: &[u8],
) -> Result<(), StateError> {
    let (header, positions) = plain::split_front::<StateHeader>(body).ok_or(StateError::Malformed)?;
    let mut positions = plain::values::<P>(positions).ok_or(StateError::Malformed)?;
    if positions.len() > publisher.initial_max_slice_len() {
        return Err(StateError::Malformed);
    }
    let says = |error: &dyn std::fmt::Debug| StateError::Transport(format!("{error:?}"));
    let sample = publisher.loan_slice_uninit(positions.len()).map_err(|error| says(&error))?;
    let mut sample = sample.write_from_fn(|_| positions.next().unwrap_or_default());
    *sample.user_header_mut() = header;
    sample.send().map_err(|error| says(&error))?;
    Ok(())
}
