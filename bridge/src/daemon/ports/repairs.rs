//! Takes repairs from the daemon.

use iceoryx2::{
    port::subscriber::Subscriber, prelude::Node, service::builder::publish_subscribe::PublishSubscribeOpenError,
};
use untangled_client::RequestError;
use untangled_proto::{PositionF32, PositionF64, Precision, RepairHeader, names::SessionService};
use untangled_transport::services::{Ipc, Position};

use super::shape::{Shape, failed};
use crate::wire::{element::Element, elements::Pins, plain};

/// Takes repairs, in the precision of the session.
#[derive(Debug)]
pub(in super::super) enum RepairPort {
    F32(Subscriber<Ipc, [PositionF32], RepairHeader>),
    F64(Subscriber<Ipc, [PositionF64], RepairHeader>),
}

impl RepairPort {
    /// Opens the repair service of a session; nothing where it has none.
    pub(in super::super) fn open(node: &Node<Ipc>, shape: &Shape) -> Result<Option<Self>, RequestError> {
        let name = shape.name(SessionService::Repair);
        Ok(match shape.precision {
            Precision::F32 => subscribe(node, &name)?.map(Self::F32),
            Precision::F64 => subscribe(node, &name)?.map(Self::F64),
        })
    }

    /// What a message carries of the next repair.
    pub(in super::super) fn take(&self, body: &mut Vec<u8>) -> bool {
        match self {
            Self::F32(port) => take(port, body),
            Self::F64(port) => take(port, body),
        }
    }
}

fn subscribe<P: Position>(
    node: &Node<Ipc>,
    name: &str,
) -> Result<Option<Subscriber<Ipc, [P], RepairHeader>>, RequestError> {
    let service = match P::open_repairs(node, name) {
        Err(PublishSubscribeOpenError::DoesNotExist) => return Ok(None),
        service => service.map_err(|error| failed("opening the repair service", &error))?,
    };
    let subscriber = service.subscriber_builder().create();
    Ok(Some(subscriber.map_err(|error| failed("creating a subscriber", &error))?))
}

fn take<P: Position + Element>(port: &Subscriber<Ipc, [P], RepairHeader>, body: &mut Vec<u8>) -> bool {
    let sample = match port.receive() {
        Ok(Some(sample)) => sample,
        Ok(None) => return false,
        Err(error) => {
            tracing::debug!(?error, "receiving a repair");
            return false;
        }
    };
    body.clear();
    body.extend_from_slice(plain::bytes_of(&[*sample.user_header()]));
    Pins::default().write(sample.payload(), body);
    true
}
