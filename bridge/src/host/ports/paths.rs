//! Hands the intersection paths of frames to whoever listens.

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, Node, PortFactory},
};
use untangled_proto::{
    PayloadLayout,
    memory::paths_sample_bytes,
    names::SessionService,
    paths::{PathPoint, PathRecord, PathsHeader},
};
use untangled_transport::{
    memory,
    services::{self, Ipc, PathsService},
};

use super::{super::refusal::Refusal, error::DeliverError, shape::Shape};
use crate::wire::plain;

/// A session's paths service. It has no publisher until there is a subscriber.
#[derive(Debug)]
pub(super) struct PathsPort {
    publisher: Option<Publisher<Ipc, [u8], PathsHeader>>,
    layout: PayloadLayout,
    service: PathsService,
}

impl PathsPort {
    pub(super) fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        let service = services::create_paths(node, &shape.name(SessionService::Paths), shape.layout)
            .map_err(|error| Refusal::failed("creating the paths service", &error))?;
        Ok(Self { publisher: None, layout: shape.layout, service })
    }

    pub(super) fn has_subscriber(&self) -> bool {
        self.service.dynamic_config().number_of_subscribers() > 0
    }

    pub(super) fn send(&mut self, body: &[u8]) -> Result<(), DeliverError> {
        let (header, payload) = plain::split_front::<PathsHeader>(body).ok_or(DeliverError::Malformed)?;
        let records = (header.num_paths as usize).checked_mul(size_of::<PathRecord>());
        let points = (header.num_points as usize).checked_mul(size_of::<PathPoint>());
        if records.zip(points).and_then(|(records, points)| records.checked_add(points)) != Some(payload.len()) {
            return Err(DeliverError::Malformed);
        }
        if !self.has_subscriber() {
            self.publisher = None;
            return Ok(());
        }
        // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
        let needed = paths_sample_bytes(2 * payload.len(), self.layout);
        if memory::free().is_ok_and(|free| free < needed) {
            return Err(DeliverError::Transport("/dev/shm is full".to_owned()));
        }
        let failed = |error: &dyn std::fmt::Debug| DeliverError::Transport(format!("{error:?}"));
        let publisher = match &mut self.publisher {
            Some(publisher) => publisher,
            none => none.insert(
                self.service
                    .publisher_builder()
                    .initial_max_slice_len(payload.len().max(4096))
                    .allocation_strategy(AllocationStrategy::PowerOfTwo)
                    .max_loaned_samples(1)
                    .create()
                    .map_err(|error| failed(&error))?,
            ),
        };
        let mut sample = publisher.loan_slice_uninit(payload.len()).map_err(|error| failed(&error))?;
        *sample.user_header_mut() = header;
        sample.write_from_slice(payload).send().map_err(|error| failed(&error))?;
        Ok(())
    }
}
