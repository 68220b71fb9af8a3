//! Hands corrections to the host, in the form that it asked for.

use iceoryx2::prelude::Node;
use untangled_proto::{CorrectionHeader, VertexCorrection, memory, names::SessionService};
use untangled_transport::services::{self, Ipc};

use super::{super::refusal::Refusal, error::DeliverError, publication::Publication, shape::Shape};
use crate::wire::{elements::Pins, message::Kind, plain};

/// Hands corrections to the host.
#[derive(Debug)]
pub(super) enum CorrectionPort {
    Dense { port: Publication<VertexCorrection, CorrectionHeader>, pins: Pins },
    Sparse(Publication<u32, CorrectionHeader>),
}

impl CorrectionPort {
    pub(super) fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        const WHAT: &str = "corrections";
        if shape.is_sparse() {
            let service = services::create_sparse_corrections(node, &shape.name(SessionService::Sparse))
                .map_err(|error| Refusal::failed("creating the service of sparse corrections", &error))?;
            let room = memory::sparse_words(shape.num_vertices, shape.options);
            return Ok(Self::Sparse(Publication::create(service, room, shape.domain, WHAT)?));
        }
        let service = services::create_corrections(node, &shape.name(SessionService::Correction), shape.layout)
            .map_err(|error| Refusal::failed("creating the correction service", &error))?;
        let port = Publication::create(service, shape.num_vertices, shape.domain, WHAT)?;
        Ok(Self::Dense { port, pins: Pins::default() })
    }

    pub(super) fn send(&mut self, kind: Kind, body: &[u8]) -> Result<(), DeliverError> {
        let (header, payload) = plain::split_front::<CorrectionHeader>(body).ok_or(DeliverError::Malformed)?;
        match self {
            Self::Dense { port, pins } if kind == Kind::Dense => {
                let num_vertices = port.room();
                let elements = pins.read::<VertexCorrection>(payload, num_vertices)?;
                let sample = port.loan(num_vertices)?;
                let mut sample = sample.write_from_fn(|index| pins.rest(&elements, index));
                let vertices = sample.payload_mut();
                for (index, vertex) in elements.entries() {
                    vertices[index] = vertex;
                }
                *sample.user_header_mut() = header;
                sample.send().map_err(|error| DeliverError::transport(&error))?;
            }
            Self::Sparse(port) if kind == Kind::Sparse => {
                let words = plain::values::<u32>(payload).ok_or(DeliverError::Malformed)?;
                if words.len() > port.room() {
                    return Err(DeliverError::Malformed);
                }
                let mut words = words;
                let sample = port.loan(words.len())?;
                let mut sample = sample.write_from_fn(|_| words.next().unwrap_or_default());
                *sample.user_header_mut() = header;
                sample.send().map_err(|error| DeliverError::transport(&error))?;
            }
            _ => return Err(DeliverError::Malformed),
        }
        Ok(())
    }
}
