//! Certificates, and rules of access for each host.
//!
//! Beyond this machine both ends show a certificate of an authority that the other end trusts (mutual TLS by Zenoh's
//! own rustls). Where a daemon end lists its hosts, the name in a host's certificate (the common name) decides what it
//! may send: keys of that name, and nothing else.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{Endpoint, Side};
use crate::{error::BridgeError, wire::BRIDGE_VERSION};

/// Files of certificates, in PEM.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tls {
    /// The authority whose certificates this end trusts.
    pub authority: PathBuf,
    /// This end's certificate, with the name of the end as its common name.
    pub certificate: PathBuf,
    /// The private key of the certificate.
    pub key: PathBuf,
}

impl Tls {
    /// Zenoh's configuration of links.
    pub(super) fn config(&self) -> Value {
        json!({
            "root_ca_certificate": self.authority,
            "enable_mtls": true,
            "listen_certificate": self.certificate,
            "listen_private_key": self.key,
            "connect_certificate": self.certificate,
            "connect_private_key": self.key,
            "verify_name_on_connect": true,
            "close_link_on_expiration": true,
        })
    }
}

/// Checks that nothing leaves this machine in the clear, unless the user insists; gives back a warning then.
///
/// # Errors
/// [`BridgeError::Config`] in words: an address beyond this machine without certificates; a file that is missing.
pub fn check(
    endpoints: &[Endpoint],
    discovery: bool,
    tls: Option<&Tls>,
    insecure: bool,
) -> Result<Option<String>, BridgeError> {
    if let Some(tls) = tls {
        for path in [&tls.authority, &tls.certificate, &tls.key] {
            std::fs::File::open(path).map_err(|source| BridgeError::File { path: path.clone(), source })?;
        }
        return Ok(None);
    }
    let beyond = endpoints.iter().find(|endpoint| !endpoint.is_loopback()).map(|endpoint| format!("`{endpoint}`"));
    let Some(beyond) = beyond.or_else(|| discovery.then(|| "discovery".to_owned())) else { return Ok(None) };
    if insecure {
        return Ok(Some(format!(
            "--insecure: {beyond} leaves this machine without encryption, and everybody who can connect can use the \
             daemon and read cloth"
        )));
    }
    Err(BridgeError::Config(format!(
        "{beyond} leaves this machine: give certificates ([tls] in the configuration), or say --insecure for a network \
         in which you trust everybody"
    )))
}

/// Zenoh's rules of access for a daemon end that lists its hosts: what is not allowed is refused.
pub(super) fn access(side: Side, name: &str, hosts: &[String]) -> Option<Value> {
    if hosts.is_empty() || side != Side::Daemon {
        return None;
    }
    let own = format!("untangled/{BRIDGE_VERSION}/{name}");
    let mut rules = vec![json!({
        "id": "beacons", "permission": "allow", "flows": ["ingress", "egress"],
        "messages": ["put", "declare_subscriber"], "key_exprs": ["untangled/*/*/beacon"],
    })];
    let mut subjects = Vec::new();
    let mut policies = Vec::new();
    for host in hosts {
        rules.push(json!({
            "id": format!("host {host}"), "permission": "allow", "flows": ["ingress", "egress"],
            "messages": ["put", "declare_subscriber", "query", "declare_queryable", "reply"],
            "key_exprs": [format!("{own}/{host}/**"), format!("untangled/{BRIDGE_VERSION}/*/{host}/down/*")],
        }));
        subjects.push(json!({ "id": format!("subject {host}"), "cert_common_names": [host] }));
        policies.push(json!({
            "rules": ["beacons", format!("host {host}"), "own"], "subjects": [format!("subject {host}")],
        }));
    }
    // What this end declares is told to each host: that it listens to the messages of all of them.
    rules.push(json!({
        "id": "own", "permission": "allow", "flows": ["egress"],
        "messages": ["declare_subscriber", "declare_queryable"], "key_exprs": [format!("{own}/**")],
    }));
    Some(json!({
        "enabled": true, "default_permission": "deny", "rules": rules, "subjects": subjects, "policies": policies,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_refuses_addresses_beyond_this_machine_without_certificates_and_warns_where_the_user_insists() {
        let [own, other] = ["127.0.0.1:1", "10.1.2.3:1"].map(|text| Endpoint::parse(text).unwrap());
        let words = |endpoints: &[Endpoint], discovery, insecure| check(endpoints, discovery, None, insecure);
        assert!(matches!(words(std::slice::from_ref(&own), false, false), Ok(None)));
        let refused = words(&[own.clone(), other.clone()], false, false).unwrap_err().to_string();
        assert!(refused.contains("10.1.2.3:1") && refused.contains("--insecure"), "{refused}");
        let refused = words(std::slice::from_ref(&own), true, false).unwrap_err().to_string();
        assert!(refused.contains("discovery"), "{refused}");
        let warning = words(&[other], false, true).unwrap().unwrap();
        assert!(warning.contains("without encryption"), "{warning}");
        let missing = Tls { authority: "/nowhere/ca.pem".into(), ..Tls::default() };
        let refused = check(&[own], false, Some(&missing), true).unwrap_err().to_string();
        assert!(refused.contains("/nowhere/ca.pem"), "{refused}");
    }
}
