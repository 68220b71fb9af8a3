//! Publishes views of a session's frames.

use std::sync::Arc;

use iceoryx2::{
    port::publisher::Publisher,
    prelude::{AllocationStrategy, PortFactory},
};
use untangled_proto::{
    memory::{view_bytes, view_sample_bytes},
    view::ViewHeader,
};
use untangled_transport::{clock, memory, services::Ipc, views::Views};

use super::{
    desk::ViewDesk,
    encode::{View, encode},
};
use crate::service::{error::ServeError, throttle::Throttle};

/// Publishes views while somebody subscribes.
#[derive(Debug)]
pub(in crate::service::session) struct ViewPort {
    publisher: Option<Publisher<Ipc, [u8], ViewHeader>>,
    bytes: Vec<u8>,
    states: Vec<u32>,
    /// Frames that were answered so far.
    num_frames: u64,
    desk: Arc<ViewDesk>,
}

impl ViewPort {
    pub(in crate::service::session) fn new(desk: Arc<ViewDesk>) -> Self {
        Self { publisher: None, bytes: Vec::new(), states: Vec::new(), num_frames: 0, desk }
    }

    /// Publishes the view of a frame whose correction has gone out, if there is a subscriber.
    pub(in crate::service::session) fn publish(&mut self, view: &View<'_>) {
        self.num_frames += 1;
        let Self { publisher, bytes, states, num_frames, desk } = self;
        let Some(views) = desk.views() else { return };
        if views.dynamic_config().number_of_subscribers() == 0 {
            // Its memory is given back.
            *publisher = None;
            return;
        }
        let sent_ns = u64::try_from(clock::monotonic().as_nanos()).unwrap_or(u64::MAX);
        let header = ViewHeader { num_frames: *num_frames, sent_ns, ..encode(view, bytes, states) };
        match send(publisher, views, view.cloth.num_vertices(), header, bytes) {
            Ok(()) => desk.announce(),
            Err(error) => {
                static FAILED: Throttle = Throttle::new();
                if let Some(num_suppressed) = FAILED.admit() {
                    tracing::warn!(%error, frame = view.correction.frame, num_suppressed, "publishing a view");
                }
            }
        }
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
