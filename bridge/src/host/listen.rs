//! What a host end hears from the network.

use std::sync::Arc;

use zenoh::{Wait, sample::Sample};

use super::shared::Shared;
use crate::{
    error::BridgeError,
    metrics::count,
    net::Network,
    wire::{
        beacon::{self, DaemonBeacon},
        keys,
        message::Envelope,
    },
};

/// Listens to beacons and to messages of sessions.
pub(super) fn subscribe(shared: &Arc<Shared>, network: &Network) -> Result<(), BridgeError> {
    let listen = |key: String, take: fn(&Shared, &Sample)| {
        // Weak, since the session of the network is a part of what is shared.
        let weak = Arc::downgrade(shared);
        shared
            .network
            .declare_subscriber(key)
            .callback(move |sample| {
                if let Some(shared) = weak.upgrade() {
                    take(&shared, &sample);
                }
            })
            .background()
            .wait()
            .map_err(|error| BridgeError::network("listening to the network", &error))
    };
    listen(keys::beacons_of_all_versions().to_owned(), hear)?;
    listen(keys::down("*", &network.name, "*"), take_message)
}

fn hear(shared: &Shared, sample: &Sample) {
    let Some(key) = keys::parse(sample.key_expr().as_str()).filter(|key| key.host.is_empty()) else { return };
    match beacon::from_bytes::<DaemonBeacon>(&sample.payload().to_bytes()) {
        Some(beacon) => shared.directory.hear(key.daemon, beacon),
        None => count(&shared.metrics.num_rejected),
    }
}

fn take_message(shared: &Shared, sample: &Sample) {
    let bytes = sample.payload().to_bytes();
    let message = keys::parse(sample.key_expr().as_str()).zip(Envelope::read(&bytes));
    let Some((key, (envelope, body))) = message else { return count(&shared.metrics.num_rejected) };
    match shared.sessions.by_link(envelope.link) {
        // The daemon that the session was registered at, and no other.
        Some(session) if key.link == envelope.link && *session.remote.daemon == *key.daemon => {
            session.receive(envelope, body);
        }
        _ => count(&shared.metrics.num_rejected),
    }
}
