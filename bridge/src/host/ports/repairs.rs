//! Hands repairs to the host, in the precision of the session.

use iceoryx2::prelude::Node;
use untangled_proto::{PositionF32, PositionF64, Precision, RepairHeader, names::SessionService};
use untangled_transport::services::{Ipc, Position};

use super::{super::refusal::Refusal, error::DeliverError, publication::Publication, shape::Shape};
use crate::wire::{element::Element, elements::Pins, plain};

/// Hands repairs to the host.
#[derive(Debug)]
pub(super) enum RepairPort {
    F32(Publication<PositionF32, RepairHeader>),
    F64(Publication<PositionF64, RepairHeader>),
}

impl RepairPort {
    pub(super) fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        Ok(match shape.precision {
            Precision::F32 => Self::F32(create(node, shape)?),
            Precision::F64 => Self::F64(create(node, shape)?),
        })
    }

    pub(super) fn send(&mut self, body: &[u8]) -> Result<(), DeliverError> {
        match self {
            Self::F32(port) => send(port, body),
            Self::F64(port) => send(port, body),
        }
    }
}

fn create<P: Position>(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Publication<P, RepairHeader>, Refusal> {
    let service = P::create_repairs(node, &shape.name(SessionService::Repair), shape.layout)
        .map_err(|error| Refusal::failed("creating the repair service", &error))?;
    Publication::create(service, shape.num_vertices, shape.domain, "repairs")
}

fn send<P: Position + Element>(port: &Publication<P, RepairHeader>, body: &[u8]) -> Result<(), DeliverError> {
    let (header, payload) = plain::split_front::<RepairHeader>(body).ok_or(DeliverError::Malformed)?;
    let mut pins = Pins::default();
    let elements = pins.read::<P>(payload, port.room())?;
    let mut sample = port.loan(port.room())?.write_from_fn(|_| P::rest(false));
    let displacements = sample.payload_mut();
    for (index, displacement) in elements.entries() {
        displacements[index] = displacement;
    }
    *sample.user_header_mut() = header;
    sample.send().map_err(|error| DeliverError::transport(&error))?;
    Ok(())
}
