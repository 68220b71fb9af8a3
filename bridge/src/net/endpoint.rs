//! Addresses, and whether they leave this machine.

use std::net::{IpAddr, SocketAddr};

use crate::error::BridgeError;

/// Where a daemon end listens, and where a host end looks for it.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:7460";

/// Which end of a bridge this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Near the host.
    Host,
    /// Near the daemon.
    Daemon,
}

/// An address as the user gave it: `HOST:PORT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint(String);

impl Endpoint {
    /// Reads an address.
    ///
    /// # Errors
    /// [`BridgeError::Config`]: it is not `HOST:PORT`, or holds characters that mean something to Zenoh.
    pub fn parse(text: &str) -> Result<Self, BridgeError> {
        let good = |host: &str, port: &str| {
            let is_host = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'.' | b':' | b'[' | b']');
            !host.is_empty() && host.bytes().all(is_host) && port.parse::<u16>().is_ok()
        };
        match text.rsplit_once(':') {
            Some((host, port)) if good(host, port) => Ok(Self(text.to_owned())),
            _ => Err(BridgeError::Config(format!("`{text}` is no address: it must be HOST:PORT, as in 10.0.0.7:7460"))),
        }
    }

    /// Whether only this machine can reach it. A name other than `localhost` counts as one that leaves the machine.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        match self.0.parse::<SocketAddr>() {
            Ok(address) => is_loopback(address.ip()),
            Err(_) => self.0.rsplit_once(':').is_some_and(|(host, _)| host == "localhost"),
        }
    }

    /// As Zenoh writes it.
    #[must_use]
    pub fn locator(&self, has_tls: bool) -> String {
        format!("{}/{}", if has_tls { "tls" } else { "tcp" }, self.0)
    }
}

impl std::fmt::Display for Endpoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

fn is_loopback(address: IpAddr) -> bool {
    match address {
        IpAddr::V4(address) => address.is_loopback(),
        IpAddr::V6(address) => address.is_loopback() || address.to_ipv4_mapped().is_some_and(|v4| v4.is_loopback()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_takes_addresses_and_tells_those_that_leave_the_machine() {
        for (text, loopback) in [
            ("127.0.0.1:7460", true),
            ("[::1]:1", true),
            ("localhost:9", true),
            ("[::ffff:127.0.0.1]:9", true),
            ("0.0.0.0:7460", false),
            ("[::]:7460", false),
            ("farm.example:7460", false),
        ] {
            let endpoint = Endpoint::parse(text).unwrap();
            assert_eq!(endpoint.is_loopback(), loopback, "{text}");
            assert_eq!(endpoint.locator(true), format!("tls/{text}"));
        }
        for bad in
            ["", "7460", "host", "host:", "host:70000", ":1", "tcp/1.2.3.4:1", "a b:1", "a:1#iface=eth0", "a?b:1"]
        {
            assert!(Endpoint::parse(bad).is_err(), "{bad}");
        }
    }
}
