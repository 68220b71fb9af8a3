//! Opens a Zenoh session.

use std::time::Duration;

use serde_json::{Value, json};
use zenoh::{
    Config, Session, Wait,
    qos::{CongestionControl, Priority},
};

use super::{Endpoint, Side, Tls, security};
use crate::error::BridgeError;

/// An end of which nothing was heard for so long is gone: six beacons.
pub const LOST_AFTER: Duration = Duration::from_millis(1500);
/// Time for one attempt to connect, and between attempts: so that both ends are back within 2 s after a partition.
const CONNECT_MS: u64 = 800;
const RETRY_MS: u64 = 100;
const LONGEST_RETRY_MS: u64 = 400;
/// A message that finds no room for so long closes the connection, which is made again.
const STUCK_US: u64 = 2_000_000;
/// Hosts that may be connected at a time, and connections that may be about to be made.
const MAX_CONNECTIONS: usize = 128;
const MAX_PENDING: usize = 16;

/// How an end takes part in the network.
#[derive(Clone, Debug)]
pub struct Network {
    /// Which end it is.
    pub side: Side,
    /// Its name, unique among all ends.
    pub name: String,
    /// Where it listens.
    pub listen: Vec<Endpoint>,
    /// Where it connects to.
    pub connect: Vec<Endpoint>,
    /// Whether the addresses to connect to are Zenoh routers.
    pub through_router: bool,
    /// Whether ends find each other by multicast.
    pub discovery: bool,
    /// Certificates, beyond this machine.
    pub tls: Option<Tls>,
    /// At a daemon end the hosts that may use it, by the common names of their certificates; empty for all that have a
    /// certificate.
    pub hosts: Vec<String>,
    /// Whether messages are compressed (LZ4).
    pub compression: bool,
    /// Longest message in bytes.
    pub max_message_bytes: usize,
}

/// In which channel a message goes. Messages of one channel of a connection keep their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// Beacons and acknowledgements, which overtake all else, and are dropped where there is no room.
    Signal,
    /// Frames and requests: they wait for room.
    Data,
}

impl Urgency {
    /// Zenoh's word for it.
    #[must_use]
    pub fn priority(self) -> Priority {
        match self {
            Self::Signal => Priority::RealTime,
            Self::Data => Priority::Data,
        }
    }

    /// Zenoh's word for it.
    #[must_use]
    pub fn congestion(self) -> CongestionControl {
        match self {
            Self::Signal => CongestionControl::Drop,
            Self::Data => CongestionControl::Block,
        }
    }
}

/// Opens a session. Addresses that do not answer are tried again in the background, for good.
///
/// # Errors
/// [`BridgeError::Network`]; in particular where an address can't be listened on.
pub fn open(network: &Network) -> Result<Session, BridgeError> {
    let mut config = Config::default();
    for (key, value) in settings(network) {
        config.insert_json5(key, &value.to_string()).map_err(|error| BridgeError::network(key, &error))?;
    }
    zenoh::open(config).wait().map_err(|error| {
        let places: Vec<String> = network.listen.iter().map(ToString::to_string).collect();
        BridgeError::network(format!("opening the network (listening on {})", places.join(", ")), &error)
    })
}

fn settings(network: &Network) -> Vec<(&'static str, Value)> {
    let has_tls = network.tls.is_some();
    let locators = |endpoints: &[Endpoint]| -> Value {
        endpoints.iter().map(|endpoint| Value::from(endpoint.locator(has_tls))).collect()
    };
    let is_host = network.side == Side::Host;
    // Hosts look for daemons; daemons let themselves be found.
    let looks_for: &[&str] = if is_host { &["router", "peer"] } else { &[] };
    let mut settings = vec![
        ("mode", if network.through_router { json!("client") } else { json!("peer") }),
        ("listen/endpoints", locators(&network.listen)),
        ("connect/endpoints", locators(&network.connect)),
        ("connect/timeout_ms", json!(-1)),
        ("connect/exit_on_failure", json!(false)),
        (
            "connect/retry",
            json!({ "period_init_ms": RETRY_MS, "period_max_ms": LONGEST_RETRY_MS, "period_increase_factor": 2 }),
        ),
        ("open/return_conditions", json!({ "connect_scouted": false, "declares": false })),
        ("scouting/multicast/enabled", json!(network.discovery)),
        ("scouting/multicast/listen", json!(!is_host)),
        ("scouting/multicast/autoconnect", json!({ "router": [], "peer": looks_for, "client": looks_for })),
        ("scouting/gossip/enabled", json!(false)),
        ("transport/unicast/open_timeout", json!(CONNECT_MS)),
        ("transport/unicast/accept_timeout", json!(2 * CONNECT_MS)),
        ("transport/unicast/accept_pending", json!(MAX_PENDING)),
        ("transport/unicast/max_sessions", json!(MAX_CONNECTIONS)),
        ("transport/unicast/compression/enabled", json!(network.compression)),
        ("transport/link/tx/lease", json!(LOST_AFTER.as_millis())),
        ("transport/link/tx/queue/congestion_control/block/wait_before_close", json!(STUCK_US)),
        ("transport/link/tx/queue/size/data", json!(8)),
        ("transport/link/rx/max_message_size", json!(network.max_message_bytes)),
        ("transport/link/rx/buffer_size", json!(1 << 20)),
    ];
    if let Some(tls) = &network.tls {
        settings.push(("transport/link/tls", tls.config()));
        settings.push(("transport/link/protocols", json!(["tls"])));
    }
    if let Some(access) = security::access(network.side, &network.name, &network.hosts) {
        settings.push(("access_control", access));
    }
    settings
}
