//! Takes the states of a session from the host.

use iceoryx2::{
    port::subscriber::Subscriber,
    prelude::{Node, PortFactory},
};
use untangled_proto::{PositionF32, PositionF64, Precision, StateHeader, names::SessionService};
use untangled_transport::services::{Ipc, Position, States};

use super::{super::refusal::Refusal, shape::Shape};
use crate::wire::plain::{self, Plain};

/// Takes states, in the precision that the host chose.
#[derive(Debug)]
pub(crate) enum StatePort {
    F32(Subscription<PositionF32>),
    F64(Subscription<PositionF64>),
}

/// A subscriber, dropped before its service.
#[derive(Debug)]
pub(crate) struct Subscription<P: Position> {
    subscriber: Subscriber<Ipc, [P], StateHeader>,
    service: States<P>,
    num_vertices: usize,
}

impl StatePort {
    pub(crate) fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        Ok(match shape.precision {
            Precision::F32 => Self::F32(Subscription::create(node, shape)?),
            Precision::F64 => Self::F64(Subscription::create(node, shape)?),
        })
    }

    /// Whether a host is there to send states.
    pub(crate) fn has_publisher(&self) -> bool {
        0 != match self {
            Self::F32(states) => states.service.dynamic_config().number_of_publishers(),
            Self::F64(states) => states.service.dynamic_config().number_of_publishers(),
        }
    }

    /// Whether a state has come.
    pub(crate) fn has_state(&self) -> bool {
        match self {
            Self::F32(states) => states.subscriber.has_samples().unwrap_or(false),
            Self::F64(states) => states.subscriber.has_samples().unwrap_or(false),
        }
    }

    /// The newest state that has come: its frame, and its header and positions in a message that `begin` makes with
    /// room for so many bytes.
    pub(crate) fn take(&self, begin: impl FnOnce(usize) -> Vec<u8>) -> Option<(u64, Vec<u8>)> {
        match self {
            Self::F32(states) => states.take(begin),
            Self::F64(states) => states.take(begin),
        }
    }
}

impl<P: Position + Plain> Subscription<P> {
    fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        let service = P::create_states(node, &shape.name(SessionService::State), shape.layout)
            .map_err(|error| Refusal::failed("creating the state service", &error))?;
        let subscriber =
            service.subscriber_builder().create().map_err(|error| Refusal::failed("creating a subscriber", &error))?;
        Ok(Self { subscriber, service, num_vertices: shape.num_vertices })
    }

    fn take(&self, begin: impl FnOnce(usize) -> Vec<u8>) -> Option<(u64, Vec<u8>)> {
        let sample = match self.subscriber.receive() {
            Ok(sample) => sample?,
            Err(error) => {
                tracing::debug!(?error, "receiving a state");
                return None;
            }
        };
        // A copy: the peer may go on writing.
        let header = *sample.user_header();
        // More positions than vertices don't fit the daemon's memory; it gives the same answer to none.
        let is_too_long = sample.payload().len() > self.num_vertices;
        let positions = if is_too_long { &[] } else { plain::bytes_of(sample.payload()) };
        let mut message = begin(size_of::<StateHeader>() + positions.len());
        message.extend_from_slice(plain::bytes_of(&[header]));
        message.extend_from_slice(positions);
        Some((header.frame, message))
    }
}
