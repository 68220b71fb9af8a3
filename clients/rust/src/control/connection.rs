//! The connection of a process to a daemon: its node, the control services, and a way to wake the daemon.

use std::time::Duration;

use iceoryx2::{
    config::Config,
    identifiers::UniqueServerId,
    port::notifier::Notifier,
    prelude::{CallbackProgression, EventId, Node, PortFactory, SignalHandlingMode},
    service::builder::request_response::RequestResponseOpenError as Open,
};
use untangled_proto::{ICEORYX2_VERSION, PayloadLayout, names};
use untangled_transport::{
    Domain,
    lock::WipeOnLeave,
    memory, node,
    services::{self, Event, Ipc, Requests},
};

use crate::error::{ConnectError, RequestError};

/// Time between two attempts at something that failed for a reason that may pass.
pub(crate) const RETRY: Duration = Duration::from_millis(10);

/// The node and the ports that a client and its sessions share.
#[derive(Debug)]
pub struct Connection {
    // Dropped in this order, ports before services before the node: each needs the next one for its own cleanup.
    notifier: Notifier<Ipc>,
    pub(crate) requests: Requests,
    /// How the samples of what is asked for there lie in shared memory.
    pub(crate) layout: PayloadLayout,
    pub(crate) replies: Event,
    pub(crate) node: Node<Ipc>,
    pub(crate) domain: Domain,
    pub(crate) timeout: Duration,
    _wipe: WipeOnLeave,
}

impl Connection {
    /// Opens the control services of a domain. Does not wait.
    ///
    /// # Errors
    /// [`ConnectError`]; in particular where no daemon serves the domain.
    pub fn open(domain: &Domain, config: &Config, timeout: Duration) -> Result<Self, ConnectError> {
        // Without a daemon there may be no folder, and a client creates none; or a daemon is about to wipe it.
        if !domain.is_announced() {
            return Err(RequestError::no_daemon(domain).into());
        }
        domain.check_folders()?;
        // iceoryx2 would wait beyond any deadline for a segment that a killed daemon left unfinished. A running daemon
        // removes such segments itself.
        let _ = memory::remove_unfinished(domain, memory::UNFINISHED_AGE);
        let node = node::create(config, SignalHandlingMode::Disabled)
            .map_err(|error| RequestError::transport("creating a node", &error))?;
        let (requests, layout) = open_requests(&node, domain)?;
        if server(&requests).is_none() {
            return Err(RequestError::no_daemon(domain).into());
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
        Ok(Self { notifier, requests, layout, replies, node, domain: domain.clone(), timeout, _wipe })
    }

    /// Wakes the daemon.
    pub fn wake(&self, event: usize) {
        // An error means that the daemon is gone; the caller that waits for an answer reports that at its deadline.
        if let Err(error) = self.notifier.notify_with_custom_event_id(EventId::new(event)) {
            tracing::debug!(?error, "waking the daemon");
        }
    }

    /// The domain.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The node that ports of this process are made on.
    #[must_use]
    pub fn node(&self) -> &Node<Ipc> {
        &self.node
    }

    /// How the samples of sessions that are registered here lie in shared memory.
    #[must_use]
    pub fn layout(&self) -> PayloadLayout {
        self.layout
    }

    /// The daemon's server. The server of a killed daemon counts until it is cleaned up.
    #[must_use]
    pub fn server(&self) -> Option<UniqueServerId> {
        server(&self.requests)
    }
}

fn open_requests(node: &Node<Ipc>, domain: &Domain) -> Result<(Requests, PayloadLayout), ConnectError> {
    services::open_requests(node).map_err(|error| match error {
        Open::DoesNotExist | Open::IsMarkedForDestruction | Open::HangsInCreation => {
            RequestError::no_daemon(domain).into()
        }
        Open::VersionMismatch | Open::ServiceInCorruptedState => ConnectError::Version {
            domain: domain.name().to_owned(),
            reason: format!("this client has iceoryx2 {ICEORYX2_VERSION}, the daemon another version ({error:?})"),
        },
        error => RequestError::transport("opening the service for requests", &error).into(),
    })
}

fn server(requests: &Requests) -> Option<UniqueServerId> {
    let mut id = None;
    requests.dynamic_config().list_servers(|server| {
        id = Some(server.server_id);
        CallbackProgression::Stop
    });
    id
}
