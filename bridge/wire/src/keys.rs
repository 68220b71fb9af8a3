//! Key expressions.
//!
//! ```text
//! untangled/1/DAEMON/beacon              daemon end to everybody
//! untangled/1/DAEMON/HOST/beacon         host end to one daemon end
//! untangled/1/DAEMON/HOST/requests       queries of a host end
//! untangled/1/DAEMON/HOST/up/LINK        states of a session, host end to daemon end
//! untangled/1/DAEMON/HOST/down/LINK      corrections of a session, daemon end to host end
//! ```
//!
//! All that a host may send begins with `untangled/1/*/HOST/`, so that one rule of access control holds it.

use crate::BRIDGE_VERSION;

/// Longest name of an end in bytes.
pub const MAX_NAME_BYTES: usize = 64;

/// Whether a name may stand in a key: 1 to 64 of `a-z A-Z 0-9 - _ .`.
#[must_use]
pub fn is_name(name: &str) -> bool {
    let good = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.');
    (1..=MAX_NAME_BYTES).contains(&name.len()) && name.bytes().all(good)
}

/// The key of a daemon's beacon, or of all with `*`.
#[must_use]
pub fn daemon_beacon(daemon: &str) -> String {
    format!("untangled/{BRIDGE_VERSION}/{daemon}/beacon")
}

/// Beacons of daemon ends of all versions.
#[must_use]
pub fn beacons_of_all_versions() -> &'static str {
    "untangled/*/*/beacon"
}

/// The key of a host's beacon for a daemon.
#[must_use]
pub fn host_beacon(daemon: &str, host: &str) -> String {
    format!("untangled/{BRIDGE_VERSION}/{daemon}/{host}/beacon")
}

/// The key of a host's requests to a daemon.
#[must_use]
pub fn requests(daemon: &str, host: &str) -> String {
    format!("untangled/{BRIDGE_VERSION}/{daemon}/{host}/requests")
}

/// The key of what a session's host end sends.
#[must_use]
pub fn up(daemon: &str, host: &str, link: &str) -> String {
    format!("untangled/{BRIDGE_VERSION}/{daemon}/{host}/up/{link}")
}

/// The key of what a session's daemon end sends.
#[must_use]
pub fn down(daemon: &str, host: &str, link: &str) -> String {
    format!("untangled/{BRIDGE_VERSION}/{daemon}/{host}/down/{link}")
}

/// A link as it stands in a key.
#[must_use]
pub fn link(link: u64) -> String {
    format!("{link:016x}")
}

/// What a key of this module names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key<'a> {
    /// The daemon end.
    pub daemon: &'a str,
    /// The host end; empty in a daemon's beacon.
    pub host: &'a str,
    /// The link; zero where the key has none.
    pub link: u64,
}

/// Reads a key; nothing where it is none of these.
#[must_use]
pub fn parse(key: &str) -> Option<Key<'_>> {
    let mut parts = key.split('/').skip(2);
    let daemon = parts.next().filter(|name| is_name(name))?;
    let second = parts.next()?;
    let Some(last) = parts.next() else {
        return (second == "beacon").then_some(Key { daemon, host: "", link: 0 });
    };
    let link = match (last, parts.next(), parts.next()) {
        ("up" | "down", Some(link), None) => u64::from_str_radix(link, 16).ok()?,
        (_, None, None) => 0,
        _ => return None,
    };
    is_name(second).then_some(Key { daemon, host: second, link })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_reads_keys_of_this_module_and_nothing_else() {
        let key = Key { daemon: "farm-1", host: "ws.7", link: 0xab };
        assert_eq!(parse(&up("farm-1", "ws.7", &link(0xab))), Some(key));
        assert_eq!(parse(&down("farm-1", "ws.7", &link(0xab))), Some(key));
        assert_eq!(parse(&requests("farm-1", "ws.7")), Some(Key { link: 0, ..key }));
        assert_eq!(parse(&daemon_beacon("farm-1")), Some(Key { host: "", link: 0, ..key }));
        let long = format!("untangled/1/{}/beacon", "x".repeat(65));
        for bad in ["", "untangled/1", "untangled/1/d", "untangled/1/d/h/up/zz", "untangled/1/d/h/up/1/2", &long] {
            assert_eq!(parse(bad), None, "{bad}");
        }
        assert!(!is_name("a b") && !is_name("*") && !is_name("a/b") && !is_name(""));
    }
}
