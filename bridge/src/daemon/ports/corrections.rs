//! Takes corrections from the daemon, in the form that the session has.

use iceoryx2::{
    port::subscriber::Subscriber,
    prelude::{Node, PortFactory, ZeroCopySend},
    service::{
        builder::publish_subscribe::PublishSubscribeOpenError::DoesNotExist,
        port_factory::publish_subscribe::PortFactory as Publications,
    },
};
use untangled_client::RequestError;
use untangled_proto::{CorrectionHeader, VertexCorrection, names::SessionService};
use untangled_transport::{
    node as nodes,
    services::{self, CorrectionService, Ipc, SparseService},
};

use super::shape::{Shape, failed};
use crate::wire::{elements::Pins, message::Kind, plain};

/// Takes corrections. Fields of a variant are dropped in order: ports before services.
#[derive(Debug)]
pub(in super::super) enum CorrectionPort {
    Dense(Subscriber<Ipc, [VertexCorrection], CorrectionHeader>, CorrectionService),
    Sparse(Subscriber<Ipc, [u32], CorrectionHeader>, SparseService),
}

impl CorrectionPort {
    /// Opens the service that the daemon has made: that of sparse corrections, or the other.
    pub(in super::super) fn open(node: &Node<Ipc>, shape: &Shape) -> Result<Self, RequestError> {
        match services::open_sparse_corrections(node, &shape.name(SessionService::Sparse)) {
            Ok(service) => return Ok(Self::Sparse(subscriber(&service)?, service)),
            Err(DoesNotExist) => {}
            Err(error) => return Err(failed("opening the service of sparse corrections", &error)),
        }
        let service = services::open_corrections(node, &shape.name(SessionService::Correction))
            .map_err(|error| failed("opening the correction service", &error))?;
        Ok(Self::Dense(subscriber(&service)?, service))
    }

    pub(in super::super) fn is_sparse(&self) -> bool {
        matches!(self, Self::Sparse(..))
    }

    /// Whether the daemon has not closed its side. Reads shared memory only.
    pub(in super::super) fn has_publisher(&self) -> bool {
        0 != match self {
            Self::Dense(_, service) => service.dynamic_config().number_of_publishers(),
            Self::Sparse(_, service) => service.dynamic_config().number_of_publishers(),
        }
    }

    /// Whether the daemon's process is gone. Costs system calls.
    pub(in super::super) fn has_dead_user(&self) -> bool {
        match self {
            Self::Dense(_, service) => nodes::has_dead_user(service),
            Self::Sparse(_, service) => nodes::has_dead_user(service),
        }
    }

    /// The next correction: its kind and its frame, and what a message carries of it, written behind `body`.
    pub(in super::super) fn take(&self, pins: &mut Pins, body: &mut Vec<u8>) -> Option<(Kind, u64)> {
        body.clear();
        match self {
            Self::Dense(corrections, _) => {
                let sample = received(corrections.receive())?;
                let header = *sample.user_header();
                body.extend_from_slice(plain::bytes_of(&[header]));
                pins.write(sample.payload(), body);
                Some((Kind::Dense, header.frame))
            }
            Self::Sparse(corrections, _) => {
                let sample = received(corrections.receive())?;
                let header = *sample.user_header();
                body.extend_from_slice(plain::bytes_of(&[header]));
                body.extend_from_slice(plain::bytes_of(sample.payload()));
                Some((Kind::Sparse, header.frame))
            }
        }
    }
}

fn received<T>(result: Result<Option<T>, iceoryx2::port::ReceiveError>) -> Option<T> {
    result.unwrap_or_else(|error| {
        tracing::debug!(?error, "receiving from the daemon");
        None
    })
}

fn subscriber<E: std::fmt::Debug + ZeroCopySend + 'static>(
    service: &Publications<Ipc, [E], CorrectionHeader>,
) -> Result<Subscriber<Ipc, [E], CorrectionHeader>, RequestError> {
    service.subscriber_builder().create().map_err(|error| failed("creating a subscriber", &error))
}
