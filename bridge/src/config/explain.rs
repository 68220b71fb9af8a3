//! The configuration with each key explained, as a file that can be read back.

use std::fmt::Write as _;

use toml::Value;

use super::model::Config;

/// Each key with its explanation, in the order of the file.
const EXPLANATIONS: [(&str, &str); 17] = [
    (
        "domain",
        "The local domain: near a host the one that is served, near a daemon that of the daemon. Empty for \
                UNTANGLED_DOMAIN, else `default`.",
    ),
    (
        "name",
        "The name of this end, which no other end may have; with `limits.hosts` the common name of its \
              certificate. Empty for one of the machine, the user and the domain.",
    ),
    ("listen", "Where a daemon end listens, each HOST:PORT."),
    ("connect", "Where a host end looks for daemon ends, each HOST:PORT; all of them are used."),
    ("through_router", "Whether the addresses of `connect` are Zenoh routers, to which both ends connect."),
    ("discovery", "Whether ends find each other by multicast, beside the addresses of `connect`."),
    ("compression", "Whether messages are compressed (LZ4); both ends must say so. Positions hardly shrink."),
    (
        "insecure",
        "Whether addresses beyond this machine may be used without certificates: everybody who can connect can \
                  use the daemon and read cloth.",
    ),
    ("[tls]", "Certificates, as PEM files. Needed beyond this machine; both ends show theirs."),
    ("tls.authority", "The authority whose certificates this end trusts."),
    ("tls.certificate", "This end's certificate."),
    ("tls.key", "The private key of the certificate."),
    (
        "limits.hosts",
        "Names of the host ends that may use this daemon end, each the common name of a certificate. Empty \
                      for all that can connect.",
    ),
    ("limits.max_sessions_per_host", "Most sessions of one host end, up to 64."),
    ("limits.max_message_mb", "Longest message in millions of bytes: a registration, or a state."),
    ("telemetry.filter", "What to log, as in `info` or `untangled_bridge=debug`."),
    ("telemetry.format", "`text`, or `json` for one document a line."),
];
const METRICS: (&str, &str) = (
    "telemetry.metrics",
    "Loopback address for metrics (/metrics) and status (/status) over \
                               HTTP, as in `127.0.0.1:9465`. Empty for none.",
);

/// The configuration as TOML, with comments.
#[must_use]
pub fn print(config: &Config) -> String {
    let table = Value::try_from(config).unwrap_or(Value::Table(toml::Table::new()));
    let mut out = String::new();
    let mut section = "";
    for (key, explanation) in EXPLANATIONS.into_iter().chain([METRICS]) {
        let (own_section, name) = key.split_once('.').unwrap_or(("", key));
        if let Some(name) = key.strip_prefix('[') {
            let is_set = table.get(name.trim_end_matches(']')).is_some();
            comment(&mut out, explanation);
            // Writing to a string does not fail.
            let _ = writeln!(out, "{}{key}", if is_set { "" } else { "# " });
            section = name.trim_end_matches(']');
            continue;
        }
        if own_section != section {
            section = own_section;
            let _ = writeln!(out, "[{section}]");
        }
        comment(&mut out, explanation);
        let place = if own_section.is_empty() { Some(&table) } else { table.get(own_section) };
        let _ = match place.and_then(|place| place.get(name)) {
            Some(value) => writeln!(out, "{name} = {value}\n"),
            None => writeln!(out, "# {name} = \"...\"\n"),
        };
    }
    out
}

/// Writes a comment in lines of at most 100 columns.
fn comment(out: &mut String, text: &str) {
    let mut line = String::from("#");
    for word in text.split_whitespace() {
        if line.len() + word.len() > 99 {
            out.push_str(&line);
            out.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line.push_str(word);
    }
    out.push_str(&line);
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::Tls;

    #[test]
    fn print_explains_every_key_and_reads_back() {
        let tls = Tls { authority: "ca.pem".into(), certificate: "a.pem".into(), key: "a.key".into() };
        for config in [Config::default(), Config { tls: Some(tls), insecure: true, ..Config::default() }] {
            let text = print(&config);
            assert_eq!(Config::parse(&text).as_ref(), Ok(&config), "{text}");
            let Value::Table(table) = Value::try_from(&config).unwrap() else { panic!("no table") };
            for (key, value) in &table {
                let names: Vec<String> = match value {
                    Value::Table(inner) => inner.keys().map(|name| format!("{key}.{name}")).collect(),
                    _ => vec![key.clone()],
                };
                for name in names {
                    let is_explained = EXPLANATIONS.iter().chain([&METRICS]).any(|(known, _)| *known == name);
                    assert!(is_explained, "{name}");
                }
            }
        }
    }
}
