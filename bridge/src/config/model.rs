//! What a user may choose, and what an end is started with for it.

use std::{
    net::SocketAddr,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use untangled_proto::limits;
use untangled_transport::Domain;

use crate::{
    error::BridgeError,
    net::{self, DEFAULT_ADDRESS, Endpoint, Network, Side, Tls},
    options::Options,
    wire::keys,
};

/// What a user may choose. `untangled-bridge config` explains each key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// The local domain; empty for that of `UNTANGLED_DOMAIN`, else `default`.
    pub domain: String,
    /// The name of this end; empty for one of the machine, the user and the domain.
    pub name: String,
    /// Where a daemon end listens.
    pub listen: Vec<String>,
    /// Where a host end looks for daemon ends.
    pub connect: Vec<String>,
    /// Whether `connect` names Zenoh routers, for both ends.
    pub through_router: bool,
    /// Whether ends find each other by multicast.
    pub discovery: bool,
    /// Whether messages are compressed.
    pub compression: bool,
    /// Whether addresses beyond this machine may be used without certificates.
    pub insecure: bool,
    /// Certificates.
    pub tls: Option<Tls>,
    /// Limits.
    pub limits: Limits,
    /// Logs and metrics.
    pub telemetry: Telemetry,
}

/// Limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Names of the hosts that may use a daemon end; empty for all.
    pub hosts: Vec<String>,
    /// Most sessions of one host end.
    pub max_sessions_per_host: usize,
    /// Longest message in millions of bytes: a registration, or a state.
    pub max_message_mb: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { hosts: Vec::new(), max_sessions_per_host: limits::MAX_SESSIONS, max_message_mb: 512 }
    }
}

/// Logs and metrics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Telemetry {
    /// What to log.
    pub filter: String,
    /// `text` or `json`.
    pub format: LogFormat,
    /// Where to serve metrics; empty for nowhere.
    pub metrics: String,
}

impl Default for Telemetry {
    fn default() -> Self {
        Self {
            filter: "info,zenoh=warn,zenoh::net::routing=error".to_owned(),
            format: LogFormat::Text,
            metrics: String::new(),
        }
    }
}

/// How log lines look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// One JSON document a line.
    Json,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            domain: String::new(),
            name: String::new(),
            listen: vec![DEFAULT_ADDRESS.to_owned()],
            connect: vec![DEFAULT_ADDRESS.to_owned()],
            through_router: false,
            discovery: false,
            compression: false,
            insecure: false,
            tls: None,
            limits: Limits::default(),
            telemetry: Telemetry::default(),
        }
    }
}

impl Config {
    /// Reads the file that is given, or `untangled/bridge.toml` in the user's folder of configurations, where there is
    /// one.
    ///
    /// # Errors
    /// [`BridgeError`], naming the file and the key at fault.
    pub fn load(file: Option<&Path>) -> Result<Self, BridgeError> {
        let (path, must_exist) = match file.map(Path::to_owned) {
            Some(path) => (path, true),
            None => match default_file() {
                Some(path) => (path, false),
                None => return Ok(Self::default()),
            },
        };
        match std::fs::read_to_string(&path) {
            Ok(text) => {
                Self::parse(&text).map_err(|reason| BridgeError::Config(format!("{}: {reason}", path.display())))
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound && !must_exist => Ok(Self::default()),
            Err(source) => Err(BridgeError::File { path, source }),
        }
    }

    /// Reads a document.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| error.to_string().trim_end().replace('\n', " "))
    }

    /// What an end is started with, and warnings.
    ///
    /// # Errors
    /// [`BridgeError::Config`] in words.
    pub fn options(&self, side: Side) -> Result<(Options, Vec<String>), BridgeError> {
        let domain = Domain::locate(Some(self.domain.as_str()).filter(|name| !name.is_empty()))?;
        let name = if self.name.is_empty() { default_name(domain.name()) } else { self.name.clone() };
        if !keys::is_name(&name) {
            let most = keys::MAX_NAME_BYTES;
            let words =
                format!("name: `{name}` must have 1 to {most} of the characters a-z, A-Z, 0-9, `-`, `_` and `.`");
            return Err(BridgeError::Config(words));
        }
        if let Some(host) = self.limits.hosts.iter().find(|host| !keys::is_name(host)) {
            return Err(BridgeError::Config(format!("limits.hosts: `{host}` is no name of a host end")));
        }
        let parse = |texts: &[String]| texts.iter().map(|text| Endpoint::parse(text)).collect::<Result<Vec<_>, _>>();
        let (listen, connect) = match side {
            Side::Host => (Vec::new(), parse(&self.connect)?),
            Side::Daemon if self.through_router => (Vec::new(), parse(&self.connect)?),
            Side::Daemon => (parse(&self.listen)?, Vec::new()),
        };
        let used = [listen.as_slice(), connect.as_slice()].concat();
        let warning = net::check(&used, self.discovery, self.tls.as_ref(), self.insecure)?;
        let max_message_bytes = self.limits.max_message_mb.saturating_mul(1_000_000);
        let network = Network {
            side,
            name,
            listen,
            connect,
            through_router: self.through_router,
            discovery: self.discovery,
            tls: self.tls.clone(),
            hosts: self.limits.hosts.clone(),
            compression: self.compression,
            max_message_bytes,
        };
        let max_sessions_per_host = self.limits.max_sessions_per_host.min(limits::MAX_SESSIONS);
        let options = Options { domain, network, max_sessions_per_host, metrics: self.metrics()? };
        Ok((options, warning.into_iter().collect()))
    }

    fn metrics(&self) -> Result<Option<SocketAddr>, BridgeError> {
        let text = &self.telemetry.metrics;
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<SocketAddr>() {
            Ok(address) if address.ip().is_loopback() => Ok(Some(address)),
            _ => Err(BridgeError::Config(format!(
                "telemetry.metrics: `{text}` must be a loopback address with a port, as in 127.0.0.1:9465"
            ))),
        }
    }
}

fn default_file() -> Option<PathBuf> {
    let folder = std::env::var_os("XDG_CONFIG_HOME").filter(|path| !path.is_empty()).map(PathBuf::from);
    let folder = folder.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".config")))?;
    Some(folder.join("untangled/bridge.toml"))
}

/// A name that no other end has: of the machine, the user and the domain.
fn default_name(domain: &str) -> String {
    let machine = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let good = |character: &char| character.is_ascii_alphanumeric() || *character == '-';
    let machine: String = machine.trim().chars().filter(good).take(24).collect();
    format!("{machine}-{}-{domain}", rustix::process::getuid().as_raw())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_loopback_by_default_and_refuse_what_can_not_be() {
        let (options, warnings) = Config { domain: "x".into(), ..Config::default() }.options(Side::Daemon).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        assert!(options.network.listen.iter().all(Endpoint::is_loopback) && options.network.connect.is_empty());
        assert!(!options.network.discovery && options.metrics.is_none());
        let refused = |text: &str| {
            let config = Config::parse(text).unwrap();
            [Side::Host, Side::Daemon].into_iter().find_map(|side| config.options(side).err()).unwrap().to_string()
        };
        assert!(refused("listen = ['0.0.0.0:7460']").contains("--insecure"));
        assert!(refused("name = 'a/b'").contains("name: `a/b`"));
        assert!(refused("connect = ['tcp/1.2.3.4:1']").contains("HOST:PORT"));
        assert!(refused("[telemetry]\nmetrics = '0.0.0.0:1'").contains("loopback"));
        assert!(refused("[limits]\nhosts = ['*']").contains("limits.hosts"));
        let unknown = Config::parse("lisen = []").unwrap_err();
        assert!(unknown.contains("lisen"), "{unknown}");
    }
}
