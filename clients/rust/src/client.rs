//! A client: connects, says hello, opens sessions.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use iceoryx2::prelude::{LogLevel, set_log_level_from_env_or};
use untangled_proto::{ICEORYX2_VERSION, PROTOCOL_VERSION, RequestKind, Status, control::Hello};
use untangled_transport::Domain;

use crate::{
    control::{Connection, RETRY, ask, deadline_in},
    error::{ConnectError, RegisterError, RequestError},
    registration::Registration,
    session::Session,
};

/// How to connect.
#[derive(Clone, Debug)]
pub struct ClientOptions {
    /// Name of the domain. Without it the environment variable `UNTANGLED_DOMAIN`, else `default`.
    pub domain: Option<String>,
    /// How long to wait for a daemon to come up and answer, and for each later request.
    pub timeout: Duration,
}

impl Default for ClientOptions {
    fn default() -> Self {
        Self { domain: None, timeout: Duration::from_secs(5) }
    }
}

/// A connection to a daemon. Sessions stay alive without it.
#[derive(Clone, Debug)]
pub struct Client {
    connection: Arc<Connection>,
    hello: Hello,
}

impl Client {
    /// Connects to the daemon of a domain, waiting for it to come up.
    ///
    /// # Errors
    /// [`ConnectError`]; in particular when no daemon answers within the timeout.
    pub fn connect(options: ClientOptions) -> Result<Self, ConnectError> {
        // What iceoryx2 reports is handled here; its own log is switched on by IOX2_LOG_LEVEL.
        set_log_level_from_env_or(LogLevel::Fatal);
        let domain = Domain::locate(options.domain.as_deref())?;
        let config = domain.config()?;
        let deadline = deadline_in(options.timeout);
        loop {
            let opened = Connection::open(&domain, &config, options.timeout);
            match opened.and_then(|connection| hello(&connection, deadline).map(|hello| (connection, hello))) {
                Ok((connection, hello)) => return Ok(Self { connection: Arc::new(connection), hello }),
                // No daemon yet, or one that is starting or cleaning up after a crashed one.
                Err(error) if error.may_pass() && Instant::now() < deadline => std::thread::sleep(RETRY),
                Err(error) => return Err(error),
            }
        }
    }

    /// The domain.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.connection.domain
    }

    /// The connection, which its sessions share.
    pub(crate) fn connection(&self) -> &Arc<Connection> {
        &self.connection
    }

    /// What the daemon said of itself when this client connected.
    #[must_use]
    pub fn daemon(&self) -> &Hello {
        &self.hello
    }

    /// Opens a session.
    ///
    /// # Errors
    /// [`RegisterError`]; a refusal names the element and the value at fault.
    pub fn register(&self, registration: Registration) -> Result<Session, RegisterError> {
        Session::open(Arc::clone(&self.connection), registration)
    }

    /// The daemon's state as a JSON document, schema `untangled.status/1`.
    ///
    /// # Errors
    /// [`RequestError`].
    pub fn status(&self) -> Result<serde_json::Value, RequestError> {
        let reply = ask(&self.connection, RequestKind::Status, deadline_in(self.connection.timeout))?;
        serde_json::from_str(&reply.text).map_err(|error| RequestError::in_words("reading the status", &error))
    }
}

/// Asks the daemon for its versions; an error where they are not this client's.
fn hello(connection: &Connection, deadline: Instant) -> Result<Hello, ConnectError> {
    let version = |reason| ConnectError::Version { domain: connection.domain.name().to_owned(), reason };
    let reply = match ask(connection, RequestKind::Hello, deadline) {
        Err(RequestError::Refused { status: Status::UnsupportedProtocol, message }) => {
            return Err(version(message));
        }
        other => other?,
    };
    let hello: Hello = serde_json::from_str(&reply.text)
        .map_err(|error| RequestError::in_words("reading the daemon's greeting", &error))?;
    if hello.protocol_version != PROTOCOL_VERSION {
        let theirs = hello.protocol_version;
        return Err(version(format!("the daemon speaks protocol {theirs}, this client {PROTOCOL_VERSION}")));
    }
    if hello.iceoryx2_version != ICEORYX2_VERSION {
        let theirs = hello.iceoryx2_version;
        return Err(version(format!("the daemon has iceoryx2 {theirs}, this client {ICEORYX2_VERSION}")));
    }
    Ok(hello)
}
