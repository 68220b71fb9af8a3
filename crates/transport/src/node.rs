//! The nodes of a domain: each process that takes part has one.
//!
//! What makes, lists and cleans up nodes reads iceoryx2's records of them, which is much generic code: it is compiled
//! here once, and not in every crate that calls it.

use iceoryx2::{
    config::Config,
    node::{NodeCreationFailure, NodeListFailure},
    prelude::{CallbackProgression, Node, NodeBuilder, NodeState, PortFactory, SignalHandlingMode, ZeroCopySend},
    service::{Service, ServiceListError, port_factory::publish_subscribe},
};
use untangled_proto::CorrectionHeader;

use crate::services::Ipc;

/// Creates the node of this process.
///
/// # Errors
/// The error of iceoryx2.
pub fn create(config: &Config, signals: SignalHandlingMode) -> Result<Node<Ipc>, NodeCreationFailure> {
    NodeBuilder::new().config(config).signal_handling_mode(signals).create::<Ipc>()
}

/// Removes the ports, services and tags of dead nodes, as far as iceoryx2 can.
pub fn clean_up_dead(node: &Node<Ipc>) {
    // The number of nodes that remain is not news: some dead nodes can never be removed.
    let _ = node.try_cleanup_dead_nodes();
}

/// The ids of all nodes that are not known to be dead.
///
/// # Errors
/// The error of iceoryx2.
pub fn living(config: &Config) -> Result<Vec<u128>, NodeListFailure> {
    let mut ids = Vec::new();
    Node::<Ipc>::list(config, |node| {
        if !matches!(node, NodeState::Dead(_)) {
            ids.push(node.node_id().value());
        }
        CallbackProgression::Continue
    })?;
    Ok(ids)
}

/// A service that no node uses: what a process leaves that is killed while it removes the service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnusedService {
    /// How the name of its record in shared memory of who uses it ends; the file may be gone.
    pub users_file_end: String,
    /// Its description in the folder of services, without the domain's prefix.
    pub description_file: String,
}

/// The services that no node uses. A service that is being created is among them for a moment.
///
/// Cost: some system calls for each service.
///
/// # Errors
/// The error of iceoryx2.
pub fn unused_services(config: &Config) -> Result<Vec<UnusedService>, ServiceListError> {
    let mut unused = Vec::new();
    Ipc::list(config, |service| {
        if service.dynamic_details.is_none_or(|users| users.nodes.is_empty()) {
            let details = &service.static_details;
            // It writes the number in base 16; the name of the file has it in base 10.
            if let Ok(id) = u128::from_str_radix(&details.unique_service_id().to_string(), 16) {
                unused.push(UnusedService {
                    users_file_end: format!("_{id}.dynamic"),
                    description_file: format!("{}.service", details.service_hash().as_str()),
                });
            }
        }
        CallbackProgression::Continue
    })?;
    Ok(unused)
}

/// Whether a process that uses a service is gone, as far as its nodes can be listed.
///
/// Cost: some system calls.
#[must_use]
pub fn has_dead_user<E: std::fmt::Debug + ZeroCopySend>(
    service: &publish_subscribe::PortFactory<Ipc, [E], CorrectionHeader>,
) -> bool {
    let mut dead = false;
    let _ = service.nodes(|node| {
        dead |= matches!(node, NodeState::Dead(_));
        CallbackProgression::Continue
    });
    dead
}
