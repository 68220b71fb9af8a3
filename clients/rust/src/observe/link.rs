//! The ports of an observer.

use std::time::{Duration, Instant};

use iceoryx2::{
    port::{listener::Listener, subscriber::Subscriber, subscriber::SubscriberCreateError},
    prelude::Node,
};
use untangled_proto::{
    limits::MAX_OBSERVERS,
    names::{self, SessionService},
    view::ViewHeader,
};
use untangled_transport::{
    Domain,
    lock::WipeOnLeave,
    services::{
        self, Event, Ipc,
        views::{self, Views},
    },
};

use super::{error::ObserveError, mesh::ObservedMesh, observation::Observation};
use crate::{
    control::{Backoff, SLICE},
    error::RequestError,
};

/// The ports of an observer. Dropped in this order: ports before services before the node, which they hold.
#[derive(Debug)]
pub(super) struct Link {
    subscriber: Subscriber<Ipc, [u8], ViewHeader>,
    listener: Listener<Ipc>,
    _views: Views,
    event: Event,
    /// The daemon's node.
    daemon: u128,
    session: u64,
    /// When the daemon's process was last checked.
    checked: Instant,
    domain: Domain,
    _wipe: WipeOnLeave,
}

impl Link {
    /// Opens the services of a session's views, which the daemon has made.
    pub(super) fn open(node: &Node<Ipc>, domain: &Domain, instance: u64, session: u64) -> Result<Self, ObserveError> {
        let name = names::session(instance, session, SessionService::View);
        let transport = |what, error: &dyn std::fmt::Debug| RequestError::transport(what, &error);
        let event = services::open_event(node, &name)
            .map_err(|error| transport("opening the event of a session's views", &error))?;
        let views = views::open_views(node, &name)
            .map_err(|error| transport("opening the service of a session's views", &error))?;
        let ended = || ObserveError::SessionEnded { session, domain: domain.name().to_owned() };
        let daemon = views::announcer(&event).ok_or_else(ended)?;
        let subscriber = views.subscriber_builder().create().map_err(|error| match error {
            SubscriberCreateError::ExceedsMaxSupportedSubscribers => {
                ObserveError::TooMany { session, most: MAX_OBSERVERS }
            }
            error => transport("creating a subscriber", &error).into(),
        })?;
        let listener = event.listener_builder().create().map_err(|error| transport("creating a listener", &error))?;
        let (domain, _wipe) = (domain.clone(), WipeOnLeave(domain.clone()));
        Ok(Self { subscriber, listener, _views: views, event, daemon, session, checked: Instant::now(), domain, _wipe })
    }

    /// The view that waits, if one does: the buffer has room for the newest only.
    pub(super) fn receive(&self, mesh: &ObservedMesh) -> Result<Option<Observation>, ObserveError> {
        let received = self.subscriber.receive();
        let Some(sample) = received.map_err(|error| RequestError::transport("receiving a view", &error))? else {
            return Ok(None);
        };
        let read = Observation::read(*sample.user_header(), sample.payload(), mesh);
        read.map(Some).map_err(|what| ObserveError::Malformed { session: self.session, what })
    }

    /// Sleeps until an event comes or a short wait is over, at most for `most`.
    pub(super) fn sleep(&self, backoff: &mut Backoff, most: Duration) {
        backoff.sleep(&self.listener, most);
    }

    /// An error where the session has ended. Asks the system for the daemon's process now and then.
    pub(super) fn check(&mut self) -> Result<(), ObserveError> {
        let (session, domain) = (self.session, self.domain.name().to_owned());
        if views::announcer(&self.event).is_none() {
            return Err(if self.domain.is_announced() {
                ObserveError::SessionEnded { session, domain }
            } else {
                ObserveError::DaemonGone { session, domain }
            });
        }
        if self.checked.elapsed() >= SLICE {
            self.checked = Instant::now();
            if views::is_dead(&self.event, self.daemon) {
                return Err(ObserveError::DaemonGone { session, domain });
            }
        }
        Ok(())
    }
}
