//! The services of those who watch a session: its views, and the event that announces them.
//!
//! Many may subscribe, so they are services of their own: a host's ports have room for one peer, and pay for no other.

use iceoryx2::{
    prelude::*,
    service::{
        builder::{
            event::EventCreateError,
            publish_subscribe::{PublishSubscribeCreateError, PublishSubscribeOpenError},
        },
        port_factory,
    },
};
use untangled_proto::{limits, names, view::ViewHeader};

use super::{Event, Ipc, service_name};
use crate::process_id::ProcessId;

/// A service of views.
pub type Views = port_factory::publish_subscribe::PortFactory<Ipc, [u8], ViewHeader>;

/// The daemon, its observers, and some that are about to see that there is no place for them.
const MAX_NODES: usize = limits::MAX_OBSERVERS + 8;

/// Creates a service of views.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_views(node: &Node<Ipc>, name: &str) -> Result<Views, PublishSubscribeCreateError> {
    node.service_builder(&service_name(name))
        .publish_subscribe::<[u8]>()
        .user_header::<ViewHeader>()
        .max_publishers(1)
        .max_subscribers(limits::MAX_OBSERVERS)
        .max_nodes(MAX_NODES)
        .history_size(0)
        .subscriber_max_buffer_size(limits::VIEW_BUFFER)
        .subscriber_max_borrowed_samples(limits::VIEW_BORROWED)
        .enable_safe_overflow(true)
        .create()
}

/// Opens a service of views.
///
/// # Errors
/// The error of iceoryx2.
pub fn open_views(node: &Node<Ipc>, name: &str) -> Result<Views, PublishSubscribeOpenError> {
    node.service_builder(&service_name(name)).publish_subscribe::<[u8]>().user_header::<ViewHeader>().open()
}

/// Creates the event that wakes observers. Its one notifier lives as long as the session.
///
/// # Errors
/// The error of iceoryx2.
pub fn create_view_event(node: &Node<Ipc>, name: &str) -> Result<Event, EventCreateError> {
    node.service_builder(&service_name(name))
        .event()
        .max_notifiers(1)
        .max_listeners(limits::MAX_OBSERVERS)
        .max_nodes(MAX_NODES)
        .event_id_max_value(names::EVENT_MAX)
        .notifier_dropped_event(EventId::new(names::EVENT_GONE))
        .notifier_dead_event(EventId::new(names::EVENT_GONE))
        .create()
}

/// The processes that subscribe to views, one entry for each subscriber. Reads shared memory only.
#[must_use]
pub fn observers(service: &Views) -> Vec<ProcessId> {
    let mut found = Vec::new();
    service.dynamic_config().list_subscribers(|subscriber| {
        found.extend(ProcessId::of(subscriber.node_id.value()));
        CallbackProgression::Continue
    });
    found
}

/// The node that announces views; none once the session has ended. Reads shared memory only.
#[must_use]
pub fn announcer(event: &Event) -> Option<u128> {
    let mut node = None;
    event.dynamic_config().list_notifiers(|notifier| {
        node = Some(notifier.node_id.value());
        CallbackProgression::Stop
    });
    node
}

/// Whether the process of a node that uses an event is gone without having cleaned up. Another user of the service may
/// die without that.
///
/// Cost: some system calls.
#[must_use]
pub fn is_dead(event: &Event, node: u128) -> bool {
    let mut dead = false;
    let _ = event.nodes(|state| {
        dead |= matches!(&state, NodeState::Dead(_)) && state.node_id().value() == node;
        CallbackProgression::Continue
    });
    dead
}
