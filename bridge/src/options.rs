//! What an end of a bridge is started with.

use std::net::SocketAddr;

use untangled_transport::Domain;

use crate::net::Network;

/// What an end of a bridge is started with.
#[derive(Clone, Debug)]
pub struct Options {
    /// The local domain: near the host that which is served, near the daemon that of the daemon.
    pub domain: Domain,
    /// How it takes part in the network.
    pub network: Network,
    /// At a daemon end most sessions of one host end.
    pub max_sessions_per_host: usize,
    /// Where to serve metrics over HTTP, if at all: loopback addresses only.
    pub metrics: Option<SocketAddr>,
}
