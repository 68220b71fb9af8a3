//! Publishes views of a session's frames.

use std::{sync::Arc, time::Duration};

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, PortFactory},
};
use untangled_proto::{
    memory::{view_bytes, view_sample_bytes},
    view::ViewHeader,
};
use untangled_transport::{
    clock, memory,
    services::{Ipc, views::Views},
    throttle::Throttle,
};

use super::{
    desk::ViewDesk,
    encode::{Memory, View, encode},
};
use crate::service::error::ServeError;

/// Least time between two views. People see no more, and a session may have thousands of frames a second, each shorter
/// than it takes to write a view.
const INTERVAL: Duration = Duration::from_millis(20);

/// Publishes views while somebody subscribes, at most one in [`INTERVAL`]. The view of a frame that comes too early
/// waits; that of the next one takes its place.
#[derive(Debug)]
pub(in crate::service::session) struct ViewPort {
    publisher: Option<Publisher<Ipc, [u8], ViewHeader>>,
    bytes: Vec<u8>,
    memory: Memory,
    /// Frames that were answered so far.
    num_frames: u64,
    /// When the last correction had been sent.
    sent: Duration,
    /// When the last view was published, by the clock of all processes.
    published: Option<Duration>,
    desk: Arc<ViewDesk>,
}

impl ViewPort {
    pub(in crate::service::session) fn new(desk: Arc<ViewDesk>) -> Self {
        Self {
            publisher: None,
            bytes: Vec::new(),
            memory: Memory::default(),
            num_frames: 0,
            sent: Duration::ZERO,
            published: None,
            desk,
        }
    }

    /// Publishes the view of a frame whose correction has gone out, if there is a subscriber; false where it has to
    /// wait.
    pub(in crate::service::session) fn publish(&mut self, view: &View<'_>) -> bool {
        self.num_frames += 1;
        if !self.is_watched() {
            return true;
        }
        self.sent = clock::monotonic();
        if let Some(published) = self.published.filter(|published| self.sent < *published + INTERVAL) {
            self.desk.postpone(published + INTERVAL);
            return false;
        }
        self.publish_now(view);
        true
    }

    /// Publishes the view of the last frame, which had to wait.
    pub(in crate::service::session) fn publish_late(&mut self, view: &View<'_>) {
        if self.is_watched() {
            self.publish_now(view);
        }
    }

    /// Whether somebody subscribes. Where nobody does, the memory of views is given back.
    fn is_watched(&mut self) -> bool {
        let is_watched = self.desk.views().is_some_and(|views| views.dynamic_config().number_of_subscribers() > 0);
        if !is_watched && self.publisher.is_some() {
            self.desk.clear();
            (self.publisher, self.published) = (None, None);
        }
        is_watched
    }

    fn publish_now(&mut self, view: &View<'_>) {
        let Self { publisher, bytes, memory, num_frames, sent, desk, .. } = self;
        let Some(views) = desk.views() else { return };
        desk.clear();
        let sent_ns = u64::try_from(sent.as_nanos()).unwrap_or(u64::MAX);
        let header = ViewHeader { num_frames: *num_frames, sent_ns, ..encode(view, bytes, memory) };
        match send(publisher, views, view.cloth.num_vertices(), header, bytes) {
            Ok(()) => desk.announce(),
            Err(error) => {
                static FAILED: Throttle = Throttle::new();
                if let Some(num_suppressed) = FAILED.admit() {
                    tracing::warn!(%error, frame = view.correction.frame, num_suppressed, "publishing a view");
                }
            }
        }
        self.published = Some(clock::monotonic());
    }
}

fn send(
    publisher: &mut Option<Publisher<Ipc, [u8], ViewHeader>>,
    views: &Views,
    num_vertices: usize,
    header: ViewHeader,
    bytes: &[u8],
) -> Result<(), ServeError> {
    // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
    if memory::free().is_ok_and(|free| free < view_sample_bytes(2 * bytes.len())) {
        return Err(ServeError::NoRoom { what: "loaning a view" });
    }
    let publisher = match publisher {
        Some(publisher) => publisher,
        none => none.insert(
            views
                .publisher_builder()
                .initial_max_slice_len(view_bytes(num_vertices))
                .allocation_strategy(AllocationStrategy::PowerOfTwo)
                .max_loaned_samples(1)
                .create()
                .map_err(|error| ServeError::transport("creating a publisher of views", &error))?,
        ),
    };
    let mut sample =
        publisher.loan_slice_uninit(bytes.len()).map_err(|error| ServeError::transport("loaning a view", &error))?;
    *sample.user_header_mut() = header;
    sample.write_from_slice(bytes).send().map_err(|error| ServeError::transport("sending a view", &error))?;
    Ok(())
}
