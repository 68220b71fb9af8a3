//! The services that carry positions, in single or in double precision: states, and repairs.

use iceoryx2::{
    prelude::*,
    service::{
        builder::publish_subscribe::{PublishSubscribeCreateError, PublishSubscribeOpenError},
        port_factory,
    },
};
use untangled_proto::{
    limits,
    memory::PayloadLayout,
    repair::RepairHeader,
    state::{PositionF32, PositionF64, StateHeader},
};

use super::{Ipc, alignment, service_name};

/// A state service of positions `P`.
pub type States<P> = port_factory::publish_subscribe::PortFactory<Ipc, [P], StateHeader>;
/// A repair service of displacements `P`.
pub type Repairs<P> = port_factory::publish_subscribe::PortFactory<Ipc, [P], RepairHeader>;

/// Positions that a state service can carry.
///
/// The services of each kind are compiled here once, and not in every crate that opens one.
pub trait Position: std::fmt::Debug + ZeroCopySend + Sized + 'static {
    /// Creates a state service.
    ///
    /// # Errors
    /// The error of iceoryx2.
    fn create_states(
        node: &Node<Ipc>,
        name: &str,
        layout: PayloadLayout,
    ) -> Result<States<Self>, PublishSubscribeCreateError>;

    /// Opens a state service.
    ///
    /// # Errors
    /// The error of iceoryx2.
    fn open_states(node: &Node<Ipc>, name: &str) -> Result<States<Self>, PublishSubscribeOpenError>;

    /// Creates a repair service.
    ///
    /// # Errors
    /// The error of iceoryx2.
    fn create_repairs(
        node: &Node<Ipc>,
        name: &str,
        layout: PayloadLayout,
    ) -> Result<Repairs<Self>, PublishSubscribeCreateError>;

    /// Opens a repair service.
    ///
    /// # Errors
    /// The error of iceoryx2.
    fn open_repairs(node: &Node<Ipc>, name: &str) -> Result<Repairs<Self>, PublishSubscribeOpenError>;
}

macro_rules! positions {
    ($position:ty) => {
        impl Position for $position {
            fn create_states(
                node: &Node<Ipc>,
                name: &str,
                layout: PayloadLayout,
            ) -> Result<States<Self>, PublishSubscribeCreateError> {
                create_states(node, name, layout)
            }

            fn open_states(node: &Node<Ipc>, name: &str) -> Result<States<Self>, PublishSubscribeOpenError> {
                open_states(node, name)
            }

            fn create_repairs(
                node: &Node<Ipc>,
                name: &str,
                layout: PayloadLayout,
            ) -> Result<Repairs<Self>, PublishSubscribeCreateError> {
                create_repairs(node, name, layout)
            }

            fn open_repairs(node: &Node<Ipc>, name: &str) -> Result<Repairs<Self>, PublishSubscribeOpenError> {
                open_repairs(node, name)
            }
        }
    };
}

positions!(PositionF32);
positions!(PositionF64);

fn create_states<P: Position>(
    node: &Node<Ipc>,
    name: &str,
    layout: PayloadLayout,
) -> Result<States<P>, PublishSubscribeCreateError> {
    node.service_builder(&service_name(name))
        .publish_subscribe::<[P]>()
        .user_header::<StateHeader>()
        .payload_alignment(alignment(layout))
        .max_publishers(1)
        .max_subscribers(1)
        .max_nodes(2)
        .history_size(0)
        .subscriber_max_buffer_size(limits::STATE_BUFFER)
        .subscriber_max_borrowed_samples(limits::STATE_BORROWED)
        .enable_safe_overflow(true)
        .create()
}

fn open_states<P: Position>(node: &Node<Ipc>, name: &str) -> Result<States<P>, PublishSubscribeOpenError> {
    node.service_builder(&service_name(name)).publish_subscribe::<[P]>().user_header::<StateHeader>().open()
}

fn create_repairs<P: Position>(
    node: &Node<Ipc>,
    name: &str,
    layout: PayloadLayout,
) -> Result<Repairs<P>, PublishSubscribeCreateError> {
    node.service_builder(&service_name(name))
        .publish_subscribe::<[P]>()
        .user_header::<RepairHeader>()
        .payload_alignment(alignment(layout))
        .max_publishers(1)
        .max_subscribers(1)
        .max_nodes(2)
        .history_size(0)
        .subscriber_max_buffer_size(limits::REPAIR_BUFFER)
        .subscriber_max_borrowed_samples(limits::REPAIR_BORROWED)
        .enable_safe_overflow(true)
        .create()
}

fn open_repairs<P: Position>(node: &Node<Ipc>, name: &str) -> Result<Repairs<P>, PublishSubscribeOpenError> {
    node.service_builder(&service_name(name)).publish_subscribe::<[P]>().user_header::<RepairHeader>().open()
}
