//! Intersection paths for subscribers of a session.

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, Node, PortFactory},
};
use untangled_proto::{
    memory::{PayloadLayout, paths_sample_bytes},
    names::{self, SessionService},
    paths::{PathPoint, PathRecord, PathsHeader, path_type},
};
use untangled_transport::{
    memory,
    services::{self, Ipc, PathsService},
    throttle::Throttle,
};

use untangle::paths::{IntersectionPaths, PathCopy, PathType};

use super::publish::pair_index;
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
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let mut num_points = 0;
    for copy in &paths.copies {
        let record = PathRecord {
            pair: count(copy.pair),
            pair_type: count(pair_index(paths.pairs[copy.pair].pair_type)),
            path_type: path_type_code(copy.path_type),
            partner: count(copy.partner),
            closed: u32::from(copy.closed),
            first_point: num_points,
            num_points: count(copy.points.len()),
            reserved: 0,
        };
        num_points += record.num_points;
        bytes.extend_from_slice(&record.to_bytes());
    }
    for point in paths.copies.iter().flat_map(|copy| points(paths, copy)) {
        bytes.extend_from_slice(&point.to_bytes());
    }
    PathsHeader { frame, num_paths: count(paths.copies.len()), num_points, ..PathsHeader::default() }
}

fn points<'a>(paths: &'a IntersectionPaths, copy: &'a PathCopy) -> impl Iterator<Item = PathPoint> + 'a {
    let segments = &paths.segments[copy.segments.clone()];
    paths.points[copy.points.clone()].iter().enumerate().map(|(k, point)| PathPoint {
        position_m: point.position.coords.into(),
        faces: segments.get(k).or(segments.last()).map_or([u32::MAX; 2], |s| [s.own.0, s.partner.0]),
    })
}

fn path_type_code(kind: PathType) -> u32 {
    match kind {
        PathType::Closed => path_type::CLOSED,
        PathType::LoopLoop => path_type::LOOP_LOOP,
        PathType::BoundaryLoopInside => path_type::BOUNDARY_LOOP_INSIDE,
        PathType::BoundaryLoopBoundary => path_type::BOUNDARY_LOOP_BOUNDARY,
        PathType::BoundaryBoundary => path_type::BOUNDARY_BOUNDARY,
        PathType::BoundaryInside => path_type::BOUNDARY_INSIDE,
        PathType::InsideInside => path_type::INSIDE_INSIDE,
    }
}
