//! What the ends say of themselves, four times a second, as JSON: unknown fields are ignored, and missing ones are
//! zero, so that ends of different versions can read each other's.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use untangled_proto::{ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION};

use crate::BRIDGE_VERSION;

/// Time between two beacons.
pub const INTERVAL: Duration = Duration::from_millis(250);
/// Longest beacon in bytes; longer ones are not read.
pub const MAX_BYTES: usize = 4096;

/// Versions of an end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// Of the messages between the ends.
    pub bridge: u16,
    /// Of the protocol between hosts and daemon.
    pub protocol: u32,
    /// Of the release.
    pub library: String,
    /// Of iceoryx2, on that machine.
    pub iceoryx2: String,
}

impl Versions {
    /// Those of this program.
    #[must_use]
    pub fn own() -> Self {
        Self {
            bridge: BRIDGE_VERSION,
            protocol: PROTOCOL_VERSION,
            library: LIBRARY_VERSION.to_owned(),
            iceoryx2: ICEORYX2_VERSION.to_owned(),
        }
    }

    /// Why an end with these versions can't talk to this program, in words; nothing where it can.
    #[must_use]
    pub fn refusal(&self) -> Option<String> {
        let own = Self::own();
        if (self.bridge, self.protocol) == (own.bridge, own.protocol) {
            return None;
        }
        Some(format!(
            "it speaks version {} of the bridge and {} of the protocol (untangled {}), this end {} and {} (untangled \
             {}): install the same release on both machines",
            self.bridge, self.protocol, self.library, own.bridge, own.protocol, own.library
        ))
    }
}

/// What a daemon end says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DaemonBeacon {
    /// Its versions.
    pub versions: Versions,
    /// Tells this run of the daemon end from the next.
    pub run: u64,
    /// The run of the daemon that it has found, or zero where there is none.
    #[serde(default)]
    pub instance: u64,
    /// Triangles of all sessions of the daemon, those of its local hosts included.
    #[serde(default)]
    pub num_faces: u64,
    /// Threads of the daemon that work on frames.
    #[serde(default)]
    pub num_workers: u64,
}

impl DaemonBeacon {
    /// Triangles for each worker, with `more` that were registered since.
    #[must_use]
    pub fn load(&self, more: u64) -> u64 {
        self.num_faces.saturating_add(more) / self.num_workers.max(1)
    }
}

/// What a host end says to a daemon end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostBeacon {
    /// Its versions.
    pub versions: Versions,
    /// Tells this run of the host end from the next.
    pub run: u64,
    /// The links that it still has with this daemon end.
    pub links: Vec<u64>,
}

/// The bytes of a beacon.
#[must_use]
pub fn to_bytes(beacon: &impl Serialize) -> Vec<u8> {
    // Structs of numbers and text always serialise.
    serde_json::to_vec(beacon).unwrap_or_default()
}

/// A beacon from its bytes; nothing where they are too many or none.
#[must_use]
pub fn from_bytes<'a, B: Deserialize<'a>>(bytes: &'a [u8]) -> Option<B> {
    if bytes.len() > MAX_BYTES { None } else { serde_json::from_slice(bytes).ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beacons_come_back_and_other_versions_are_refused_in_words() {
        let beacon = HostBeacon { versions: Versions::own(), run: u64::MAX, links: vec![1, u64::MAX] };
        assert_eq!(from_bytes::<HostBeacon>(&to_bytes(&beacon)), Some(beacon.clone()));
        assert_eq!(beacon.versions.refusal(), None);
        assert_eq!(from_bytes::<HostBeacon>(b"{}"), None);
        assert_eq!(from_bytes::<HostBeacon>(&[b' '; MAX_BYTES + 1]), None);
        let longest = HostBeacon { links: vec![u64::MAX; 128], ..beacon.clone() };
        assert!(to_bytes(&longest).len() <= MAX_BYTES);
        let newer = r#"{"versions":{"bridge":9,"protocol":1,"library":"7","iceoryx2":"0.10.0"},"run":1,"new":2}"#;
        let newer: DaemonBeacon = from_bytes(newer.as_bytes()).unwrap();
        let words = newer.versions.refusal().unwrap();
        assert!(words.contains("version 9 of the bridge") && words.contains("same release"), "{words}");
        assert_eq!(DaemonBeacon { num_faces: 9, num_workers: 2, ..newer }.load(2), 5);
    }
}
