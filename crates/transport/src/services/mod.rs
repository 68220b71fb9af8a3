//! The iceoryx2 services and their quality of service. Both sides create and open them here, so that they agree.
//!
//! The daemon creates services, clients open them. Opening states no limits and no alignment, so that a client takes
//! those of the daemon.

mod positions;
pub mod views;

use iceoryx2::{
    prelude::*,
    service::{
        builder::{
            event::{EventCreateError, EventOpenError, EventOpenOrCreateError},
            publish_subscribe::{PublishSubscribeCreateError, PublishSubscribeOpenError},
            request_response::{RequestResponseOpenError, RequestResponseOpenOrCreateError},
        },
        port_factory,
    },
};

use untangled_proto::{
    control::{ReplyHeader, RequestHeader},
    correction::{CorrectionHeader, VertexCorrection},
    limits,
    memory::{PADDED_ALIGNMENT, PayloadLayout},
    names,
    paths::PathsHeader,
};

pub use positions::{Position, Repairs, States};

/// The variant of iceoryx2 whose ports may move between threads. It can talk to peers of the other variant.
pub type Ipc = ipc_threadsafe::Service;
/// A service for requests.
pub type Requests = port_factory::request_response::PortFactory<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;
/// A correction service.
pub type CorrectionService = port_factory::publish_subscribe::PortFactory<Ipc, [VertexCorrection], CorrectionHeader>;
/// A service of sparse corrections.
pub type SparseService = port_factory::publish_subscribe::PortFactory<Ipc, [u32], CorrectionHeader>;
/// A paths service.
pub type PathsService = port_factory::publish_subscribe::PortFactory<Ipc, [u8], PathsHeader>;
/// An event service.
pub type Event = port_factory::event::PortFactory<Ipc>;

const MAX_NODES: usize = limits::MAX_CLIENTS + 8;

fn service_name(name: &str) -> ServiceName {
    // Names are built in `names` from short literals and numbers.
    ServiceName::new(name).unwrap_or_else(|error| panic!("service name {name}: {error:?}"))
}

/// The alignment to ask for where each element is to be padded. To ask for 1 leaves an element type its own alignment.
fn alignment(layout: PayloadLayout) -> Alignment {
    let bytes = match layout {
        PayloadLayout::Packed => 1,
        PayloadLayout::Padded => PADDED_ALIGNMENT,
    };
    Alignment::new(bytes).unwrap_or(Alignment::ALIGN_1)
}

/// Opens or creates the service for requests; only the daemon makes a server for it.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_requests(node: &Node<Ipc>, layout: PayloadLayout) -> Result<Requests, RequestResponseOpenOrCreateError> {
    node.service_builder(&service_name(requests_name(layout)))
        .request_response::<[u8], [u8]>()
        .request_user_header::<RequestHeader>()
        .response_user_header::<ReplyHeader>()
        .request_payload_alignment(alignment(layout))
        .response_payload_alignment(alignment(layout))
        .max_servers(1)
        .max_clients(limits::MAX_CLIENTS)
        .max_nodes(MAX_NODES)
        .max_active_requests_per_client(1)
        .max_loaned_requests(1)
        .max_response_buffer_size(1)
        .max_borrowed_responses_per_pending_response(1)
        .open_or_create()
}

/// Opens the service for requests, that of a daemon of release 0.1 where there is no other.
///
/// # Errors
/// The error of iceoryx2; the service does not exist where no daemon runs.
pub fn open_requests(node: &Node<Ipc>) -> Result<(Requests, PayloadLayout), RequestResponseOpenError> {
    let open = |layout| {
        node.service_builder(&service_name(requests_name(layout)))
            .request_response::<[u8], [u8]>()
            .request_user_header::<RequestHeader>()
            .response_user_header::<ReplyHeader>()
            .open()
            .map(|service| (service, layout))
    };
    match open(PayloadLayout::Packed) {
        Err(RequestResponseOpenError::DoesNotExist) => open(PayloadLayout::Padded),
        opened => opened,
    }
}

fn requests_name(layout: PayloadLayout) -> &'static str {
    match layout {
        PayloadLayout::Packed => names::REQUESTS,
        PayloadLayout::Padded => names::CONTROL,
    }
}

/// Opens or creates one of the two events that all clients share.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_shared_event(node: &Node<Ipc>, name: &str) -> Result<Event, EventOpenOrCreateError> {
    node.service_builder(&service_name(name))
        .event()
        .max_notifiers(limits::MAX_CLIENTS + 1)
        .max_listeners(limits::MAX_CLIENTS + 1)
        .max_nodes(MAX_NODES)
        .event_id_max_value(names::EVENT_MAX)
        .open_or_create()
}

/// Opens an event.
///
/// # Errors
/// The error of iceoryx2.
pub fn open_event(node: &Node<Ipc>, name: &str) -> Result<Event, EventOpenError> {
    node.service_builder(&service_name(name)).event().open()
}

/// Creates the event of a session.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_session_event(node: &Node<Ipc>, name: &str) -> Result<Event, EventCreateError> {
    node.service_builder(&service_name(name))
        .event()
        .max_notifiers(2)
        .max_listeners(1 + limits::PATHS_SUBSCRIBERS)
        .max_nodes(2 + limits::PATHS_SUBSCRIBERS)
        .event_id_max_value(names::EVENT_MAX)
        .notifier_dropped_event(EventId::new(names::EVENT_GONE))
        .notifier_dead_event(EventId::new(names::EVENT_GONE))
        .create()
}

/// Creates a correction service.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_corrections(
    node: &Node<Ipc>,
    name: &str,
    layout: PayloadLayout,
) -> Result<CorrectionService, PublishSubscribeCreateError> {
    create_frames(node, name, layout)
}

/// Opens a correction service.
///
/// # Errors
/// The error of iceoryx2.
pub fn open_corrections(node: &Node<Ipc>, name: &str) -> Result<CorrectionService, PublishSubscribeOpenError> {
    open_frames(node, name)
}

/// Creates a service of sparse corrections, which are packed.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_sparse_corrections(node: &Node<Ipc>, name: &str) -> Result<SparseService, PublishSubscribeCreateError> {
    create_frames(node, name, PayloadLayout::Packed)
}

/// Opens a service of sparse corrections.
///
/// # Errors
/// The error of iceoryx2.
pub fn open_sparse_corrections(node: &Node<Ipc>, name: &str) -> Result<SparseService, PublishSubscribeOpenError> {
    open_frames(node, name)
}

/// A service for one answer to each frame, with the limits of corrections.
type Frames<E> = port_factory::publish_subscribe::PortFactory<Ipc, [E], CorrectionHeader>;

fn create_frames<E: std::fmt::Debug + ZeroCopySend + 'static>(
    node: &Node<Ipc>,
    name: &str,
    layout: PayloadLayout,
) -> Result<Frames<E>, PublishSubscribeCreateError> {
    node.service_builder(&service_name(name))
        .publish_subscribe::<[E]>()
        .user_header::<CorrectionHeader>()
        .payload_alignment(alignment(layout))
        .max_publishers(1)
        .max_subscribers(1)
        .max_nodes(2)
        .history_size(0)
        .subscriber_max_buffer_size(limits::CORRECTION_BUFFER)
        .subscriber_max_borrowed_samples(limits::CORRECTION_BORROWED)
        .enable_safe_overflow(true)
        .create()
}

fn open_frames<E: std::fmt::Debug + ZeroCopySend + 'static>(
    node: &Node<Ipc>,
    name: &str,
) -> Result<Frames<E>, PublishSubscribeOpenError> {
    node.service_builder(&service_name(name)).publish_subscribe::<[E]>().user_header::<CorrectionHeader>().open()
}

/// Creates a paths service.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_paths(
    node: &Node<Ipc>,
    name: &str,
    layout: PayloadLayout,
) -> Result<PathsService, PublishSubscribeCreateError> {
    node.service_builder(&service_name(name))
        .publish_subscribe::<[u8]>()
        .user_header::<PathsHeader>()
        .payload_alignment(alignment(layout))
        .max_publishers(1)
        .max_subscribers(limits::PATHS_SUBSCRIBERS)
        .max_nodes(2 + limits::PATHS_SUBSCRIBERS)
        .history_size(0)
        .subscriber_max_buffer_size(1)
        .subscriber_max_borrowed_samples(limits::PATHS_BORROWED)
        .enable_safe_overflow(true)
        .create()
}

/// Opens a paths service.
///
/// # Errors
/// The error of iceoryx2.
pub fn open_paths(node: &Node<Ipc>, name: &str) -> Result<PathsService, PublishSubscribeOpenError> {
    node.service_builder(&service_name(name)).publish_subscribe::<[u8]>().user_header::<PathsHeader>().open()
}
