//! Intersection paths for subscribers of a session.

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, Node, PortFactory},
};
use untangled_proto::{
    memory::{PayloadLayout, paths_sample_bytes},
    names::{self, SessionService},
    paths::PathsHeader,
    view::path_state,
};
use untangled_transport::{
    memory,
    services::{self, Ipc, PathsService},
    throttle::Throttle,
};

use untangle::paths::IntersectionPaths;

use super::records;
use crate::service::error::ServeError;

/// A session's paths service. It has no publisher, and costs nothing per frame, until there is a subscriber.
#[derive(Debug)]
pub(crate) struct PathsPort {
    publisher: Option<Publisher<Ipc, [u8], PathsHeader>>,
    bytes: Vec<u8>,
    layout: PayloadLayout,
    service: PathsService,
}

impl PathsPort {
    pub(crate) fn create(
        node: &Node<Ipc>,
        instance: u64,
        session: u64,
        layout: PayloadLayout,
    ) -> Result<Self, ServeError> {
        let name = names::session(instance, session, SessionService::Paths);
        let service = services::create_paths(node, &name, layout)
            .map_err(|error| ServeError::transport("creating the paths service", &error))?;
        Ok(Self { publisher: None, bytes: Vec::new(), layout, service })
    }

    /// Publishes the paths of a frame, if there is a subscriber.
    pub(crate) fn publish(&mut self, frame: u64, paths: &IntersectionPaths) {
        if self.service.dynamic_config().number_of_subscribers() == 0 {
            self.publisher = None;
            return;
        }
        if let Err(error) = self.try_publish(frame, paths) {
            static FAILED: Throttle = Throttle::new();
            if let Some(num_suppressed) = FAILED.admit() {
                tracing::warn!(%error, frame, num_suppressed, "publishing paths");
            }
        }
    }

    fn try_publish(&mut self, frame: u64, paths: &IntersectionPaths) -> Result<(), ServeError> {
        let header = encode(frame, paths, &mut self.bytes);
        // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
        let needed = paths_sample_bytes(2 * self.bytes.len(), self.layout);
        if memory::free().is_ok_and(|free| free < needed) {
            return Err(ServeError::NoRoom { what: "loaning a sample" });
        }
        let publisher = match &mut self.publisher {
            Some(publisher) => publisher,
            none => none.insert(
                self.service
                    .publisher_builder()
                    .initial_max_slice_len(self.bytes.len().max(4096))
                    .allocation_strategy(AllocationStrategy::PowerOfTwo)
                    .max_loaned_samples(1)
                    .create()
                    .map_err(|error| ServeError::transport("creating a publisher", &error))?,
            ),
        };
        let mut sample = publisher
            .loan_slice_uninit(self.bytes.len())
            .map_err(|error| ServeError::transport("loaning a sample", &error))?;
        *sample.user_header_mut() = header;
        sample
            .write_from_slice(&self.bytes)
            .send()
            .map_err(|error| ServeError::transport("sending a sample", &error))?;
        Ok(())
    }
}

/// Writes records and points into `bytes`.
fn encode(frame: u64, paths: &IntersectionPaths, bytes: &mut Vec<u8>) -> PathsHeader {
    bytes.clear();
    let [num_paths, num_points] = records::write(paths, |_| path_state::UNKNOWN, bytes);
    PathsHeader { frame, num_paths, num_points, ..PathsHeader::default() }
}
