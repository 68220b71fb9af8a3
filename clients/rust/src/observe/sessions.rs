//! What there is to watch.

use std::time::Duration;

use serde_json::Value;
use untangled_proto::RequestKind;

use super::error::ObserveError;
use crate::{
    client::{Client, ClientOptions},
    control::{ask, deadline_in},
    error::RequestError,
};

/// How to watch.
#[derive(Clone, Debug)]
pub struct ObserverOptions {
    /// Name of the domain. Without it the environment variable `UNTANGLED_DOMAIN`, else `default`.
    pub domain: Option<String>,
    /// How long to wait for a daemon to come up and answer.
    pub timeout: Duration,
    /// What `untangled status` calls this observer, at most 64 bytes; without it the name of the process's program.
    pub name: Option<String>,
}

impl Default for ObserverOptions {
    fn default() -> Self {
        let ClientOptions { domain, timeout } = ClientOptions::default();
        Self { domain, timeout, name: None }
    }
}

/// A process that takes part in a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObservedProcess {
    /// Its id.
    pub pid: u32,
    /// The name of its program, or what it calls itself; empty where nobody knows.
    pub name: String,
}

/// A session that may be watched, at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedSession {
    /// Its id, which no other session of this run of the daemon has.
    pub session: u64,
    /// The run of the daemon.
    pub instance: u64,
    /// The process that registered it; none where the daemon does not say.
    pub host: Option<ObservedProcess>,
    /// Number of its vertices.
    pub num_vertices: u64,
    /// Number of its faces.
    pub num_faces: u64,
    /// Frames that were answered so far.
    pub num_frames: u64,
    /// Frames a second.
    pub rate_hz: f64,
    /// Who watches it.
    pub observers: Vec<ObservedProcess>,
}

/// The sessions that a daemon serves now, by their ids.
///
/// # Errors
/// [`ObserveError::Connect`] and [`ObserveError::Request`].
pub fn sessions(options: &ObserverOptions) -> Result<Vec<ObservedSession>, ObserveError> {
    list(&connect(options)?)
}

pub(super) fn connect(options: &ObserverOptions) -> Result<Client, ObserveError> {
    Ok(Client::connect(ClientOptions { domain: options.domain.clone(), timeout: options.timeout })?)
}

pub(super) fn list(client: &Client) -> Result<Vec<ObservedSession>, ObserveError> {
    let connection = client.connection();
    let reply = ask(connection, RequestKind::Status, deadline_in(connection.timeout))?;
    let report: Value =
        serde_json::from_str(&reply.text).map_err(|error| RequestError::in_words("reading the status", &error))?;
    let sessions = report["sessions"].as_array().map_or(&[][..], Vec::as_slice);
    let mut found: Vec<_> = sessions.iter().map(|session| read(session, reply.header.instance)).collect();
    found.sort_by_key(|session| session.session);
    Ok(found)
}

fn read(session: &Value, instance: u64) -> ObservedSession {
    let count = |name: &str| session[name].as_u64().unwrap_or(0);
    let observers = session["observers"].as_array().map_or(&[][..], Vec::as_slice);
    ObservedSession {
        session: count("session"),
        instance,
        host: process(&session["host"]),
        num_vertices: count("num_vertices"),
        num_faces: count("num_faces"),
        num_frames: count("num_frames"),
        rate_hz: session["rate_hz"].as_f64().unwrap_or(0.0),
        observers: observers.iter().filter_map(process).collect(),
    }
}

fn process(value: &Value) -> Option<ObservedProcess> {
    let pid = u32::try_from(value["pid"].as_u64()?).ok()?;
    Some(ObservedProcess { pid, name: value["name"].as_str().unwrap_or_default().to_owned() })
}
