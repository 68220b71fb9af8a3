//! The connection to a daemon.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use iceoryx2::{
    identifiers::UniqueServerId,
    port::notifier::Notifier,
    prelude::{
        CallbackProgression, EventId, LogLevel, Node, NodeBuilder, PortFactory, SignalHandlingMode,
        set_log_level_from_env_or,
    },
};
use untangled_proto::{ICEORYX2_VERSION, PROTOCOL_VERSION, RequestKind, Status, control::Hello, names};
use untangled_transport::{
    Domain,
    lock::WipeOnLeave,
    memory,
    services::{self, Control, Event, Ipc},
};

use crate::{
    error::{ConnectError, RegisterError, RequestError},
    registration::Registration,
    request::Pending,
    session::Session,
};

/// How long to sleep before trying again what may pass.
pub(crate) const RETRY: Duration = Duration::from_millis(10);

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
    shared: Arc<Shared>,
    hello: Hello,
}

/// What a client's sessions share.
#[derive(Debug)]
pub(crate) struct Shared {
    // Ports before services before the node: each needs the next one to clean up behind itself.
    notifier: Notifier<Ipc>,
    pub(crate) control: Control,
    pub(crate) replies: Event,
    pub(crate) node: Node<Ipc>,
    pub(crate) domain: Domain,
    pub(crate) timeout: Duration,
    _wipe: WipeOnLeave,
}

impl Client {
    /// Connects to the daemon of a domain, waiting for it to come up.
    ///
    /// # Errors
    /// [`ConnectError`]; in particular when no daemon answers within the timeout.
    pub fn connect(options: ClientOptions) -> Result<Self, ConnectError> {
        // iceoryx2 reports many things that are handled here; whoever wants them sets IOX2_LOG_LEVEL.
        set_log_level_from_env_or(LogLevel::Fatal);
        let domain = Domain::locate(options.domain.as_deref())?;
        let config = domain.config()?;
        let deadline = Instant::now() + options.timeout;
        loop {
            let opened = Shared::open(&domain, &config, options.timeout);
            match opened.and_then(|shared| shared.hello(deadline).map(|hello| (shared, hello))) {
                Ok((shared, hello)) => return Ok(Self { shared: Arc::new(shared), hello }),
                // No daemon yet, or one that is just coming up or cleaning up behind others.
                Err(error) if error.may_pass() && Instant::now() < deadline => std::thread::sleep(RETRY),
                Err(error) => return Err(error),
            }
        }
    }

    /// The domain.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.shared.domain
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
        Session::open(Arc::clone(&self.shared), registration)
    }

    /// The daemon's state as a JSON document, schema `untangled.status/1`.
    ///
    /// # Errors
    /// [`RequestError`].
    pub fn status(&self) -> Result<serde_json::Value, RequestError> {
        let pending = Pending::send(&self.shared, RequestKind::Status, 0, &[], 0)?;
        let reply = pending.wait(&self.shared, Instant::now() + self.shared.timeout)?;
        serde_json::from_str(&reply.text).map_err(|error| RequestError::transport("reading the status", &error))
    }
}

impl Shared {
    fn open(domain: &Domain, config: &iceoryx2::config::Config, timeout: Duration) -> Result<Self, ConnectError> {
        let no_daemon = || RequestError::NoDaemon { domain: domain.name().to_owned() };
        // Without a daemon there may be no folder, and a client leaves none behind; or it is about to be wiped.
        if !domain.is_announced() {
            return Err(no_daemon().into());
        }
        domain.check_folders()?;
        // What a killed daemon left unfinished would be waited for beyond any deadline. The daemon itself looks all the time.
        let _ = memory::remove_unfinished(domain, memory::UNFINISHED_AGE);
        let node = NodeBuilder::new()
            .config(config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|error| RequestError::transport("creating a node", &error))?;
        let control = services::open_control(&node).map_err(|error| {
            use iceoryx2::service::builder::request_response::RequestResponseOpenError as Open;
            match error {
                Open::DoesNotExist | Open::IsMarkedForDestruction | Open::HangsInCreation => no_daemon().into(),
                Open::VersionMismatch | Open::ServiceInCorruptedState => ConnectError::Version {
                    domain: domain.name().to_owned(),
                    reason: format!(
                        "this client has iceoryx2 {ICEORYX2_VERSION}, the daemon another version ({error:?})"
                    ),
                },
                error => RequestError::transport("opening the control service", &error).into(),
            }
        })?;
        if server(&control).is_none() {
            return Err(no_daemon().into());
        }
        let notifier = services::open_event(&node, names::CONTROL)
            .map_err(|error| RequestError::transport("opening the control event", &error))?
            .notifier_builder()
            .create()
            .map_err(|error| RequestError::transport("creating a notifier", &error))?;
        // Held open, so that it outlives the daemon and the next one finds it.
        let replies = services::open_event(&node, names::REPLY)
            .map_err(|error| RequestError::transport("opening the reply event", &error))?;
        let _wipe = WipeOnLeave(domain.clone());
        Ok(Self { notifier, control, replies, node, domain: domain.clone(), timeout, _wipe })
    }

    fn hello(&self, deadline: Instant) -> Result<Hello, ConnectError> {
        let version = |reason| ConnectError::Version { domain: self.domain.name().to_owned(), reason };
        let pending = Pending::send(self, RequestKind::Hello, 0, &[], 0)?;
        let reply = match pending.wait(self, deadline) {
            Err(RequestError::Refused { status: Status::UnsupportedProtocol, message }) => {
                return Err(version(message));
            }
            other => other?,
        };
        let hello: Hello = serde_json::from_str(&reply.text)
            .map_err(|error| RequestError::transport("reading the daemon's greeting", &error))?;
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

    /// Wakes the daemon.
    pub(crate) fn wake(&self, event: usize) {
        // A listener that can't be reached is a daemon that is gone; the deadline of whoever waits reports it.
        if let Err(error) = self.notifier.notify_with_custom_event_id(EventId::new(event)) {
            tracing::debug!(?error, "waking the daemon");
        }
    }

    /// The daemon's server. A killed one counts until somebody has cleaned up behind it.
    pub(crate) fn server(&self) -> Option<UniqueServerId> {
        server(&self.control)
    }
}

fn server(control: &Control) -> Option<UniqueServerId> {
    let mut id = None;
    control.dynamic_config().list_servers(|server| {
        id = Some(server.server_id);
        CallbackProgression::Stop
    });
    id
}
