//! The daemon of the local domain, as a client knows it.

use std::time::{Duration, Instant};

use iceoryx2::identifiers::UniqueServerId;
use serde_json::Value;
use untangled_client::{
    ConnectError, RequestError,
    control::{Connection, Pending, RawReply},
};
use untangled_proto::{PROTOCOL_VERSION, RequestHeader, RequestKind};
use untangled_transport::{Domain, search};

/// Longest wait for the reply to a request of the bridge's own.
const PATIENCE: Duration = Duration::from_secs(2);
/// How often it is checked, while a request is open, whether the daemon is still there.
const SLICE: Duration = Duration::from_millis(250);

/// A connection to a run of the daemon.
#[derive(Debug)]
pub(super) struct Local {
    connection: Connection,
    server: UniqueServerId,
    /// Which run of the daemon it is.
    pub(super) instance: u64,
}

/// How much a daemon has to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Load {
    pub(super) num_faces: u64,
    pub(super) num_workers: u64,
}

impl Local {
    /// Connects, where a daemon serves.
    pub(super) fn open(domain: &Domain) -> Result<Self, ConnectError> {
        if !search::is_served(domain) {
            return Err(no_daemon(domain).into());
        }
        let connection = Connection::open(domain, &domain.config()?, PATIENCE)?;
        let server = connection.server().ok_or_else(|| no_daemon(domain))?;
        let reply = ask(&connection, RequestKind::Hello)?;
        Ok(Self { connection, server, instance: reply.header.instance })
    }

    pub(super) fn connection(&self) -> &Connection {
        &self.connection
    }

    /// Whether that run of the daemon is still there.
    pub(super) fn is_there(&self) -> bool {
        self.connection.server() == Some(self.server) && search::is_served(self.connection.domain())
    }

    /// Asks the daemon how much it has to do.
    pub(super) fn load(&self) -> Option<Load> {
        let reply = ask(&self.connection, RequestKind::Status).ok()?;
        let report: Value = serde_json::from_slice(&reply.payload).ok()?;
        let sessions = report["sessions"].as_array()?;
        Some(Load {
            num_faces: sessions.iter().filter_map(|session| session["num_faces"].as_u64()).sum(),
            num_workers: report["num_workers"].as_u64()?,
        })
    }

    /// Passes a request on, and waits for the reply up to the deadline.
    pub(super) fn forward(
        &self,
        header: &RequestHeader,
        payload: &[u8],
        time: Duration,
    ) -> Result<RawReply, RequestError> {
        let pending = Pending::forward(&self.connection, header, payload)?;
        let deadline = Instant::now() + time;
        while self.is_there() && Instant::now() < deadline {
            if let Some(reply) = pending.poll_raw(&self.connection, deadline.min(Instant::now() + SLICE))? {
                return Ok(reply);
            }
        }
        Err(no_daemon(self.connection.domain()))
    }
}

fn ask(connection: &Connection, kind: RequestKind) -> Result<RawReply, RequestError> {
    let header = RequestHeader { protocol_version: PROTOCOL_VERSION, kind: kind as u32, ..RequestHeader::default() };
    let pending = Pending::forward(connection, &header, &[])?;
    let reply = pending.poll_raw(connection, Instant::now() + PATIENCE)?;
    reply.ok_or_else(|| no_daemon(connection.domain()))
}

fn no_daemon(domain: &Domain) -> RequestError {
    RequestError::Transport { what: "asking the daemon", reason: format!("none answers in domain `{}`", domain.name()) }
}
