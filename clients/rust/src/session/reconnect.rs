//! The link of a session, which is registered again after a daemon went away.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use untangled_proto::{RequestKind, SessionOptions, names};

use super::link::Link;
use crate::{
    control::{Connection, Pending, RETRY, Reply, deadline_in},
    error::{PublishError, RegisterError, RequestError},
    registration::Registration,
};

/// A link that is registered again by the next call after a daemon went away.
///
/// ```text
///            reply                       daemon gone
/// Pending ----------> Live --------------------------------> Lost
///    ^                                                        |
///    +------------------- next call, a daemon is up ----------+
/// ```
#[derive(Debug)]
pub(crate) struct ReconnectingLink {
    // Dropped first: the daemon must see the ports gone before it is woken.
    state: State,
    registration: Registration,
    options: SessionOptions,
    num_welded: usize,
    num_registrations: u32,
    connection: Arc<Connection>,
}

/// After this time the daemon has seen the ports of a session: it looks twice a second.
const SEEN: Duration = Duration::from_secs(1);
/// Longest wait for the reply to the request that closes a session. Without one the daemon closes it by itself.
const CLOSE: Duration = Duration::from_millis(100);

#[derive(Debug)]
enum State {
    Live(Box<Link>),
    Pending(Box<Pending>),
    Lost,
}

impl ReconnectingLink {
    /// Registers, up to the timeout of the connection.
    pub(crate) fn open(connection: Arc<Connection>, registration: Registration) -> Result<Self, RegisterError> {
        let deadline = deadline_in(connection.timeout);
        let (payload, num_sections) = registration.encode();
        let attempt = || {
            let pending = Pending::send(&connection, RequestKind::Register, 0, &payload, num_sections)?;
            let reply = pending.wait(&connection, deadline)?;
            Link::open(&connection.node, &connection.domain, &reply, &registration, connection.layout)
        };
        let link = loop {
            match attempt() {
                Ok(link) => break link,
                Err(error) if error.may_pass() && Instant::now() < deadline => std::thread::sleep(RETRY),
                Err(error) => return Err(error.into()),
            }
        };
        let (options, num_welded) = (link.corrections.options(), link.num_welded);
        let state = State::Live(Box::new(link));
        Ok(Self { state, registration, options, num_welded, num_registrations: 1, connection })
    }

    pub(crate) fn connection(&self) -> &Connection {
        &self.connection
    }

    pub(crate) fn num_vertices(&self) -> usize {
        self.registration.num_vertices
    }

    pub(crate) fn num_faces(&self) -> usize {
        self.registration.triangles.len()
    }

    /// What the last link has of what was asked for.
    pub(crate) fn options(&self) -> SessionOptions {
        self.options
    }

    /// Vertices that became one with another in the last link.
    pub(crate) fn num_welded(&self) -> usize {
        self.num_welded
    }

    /// How often this was registered.
    pub(crate) fn num_registrations(&self) -> u32 {
        self.num_registrations
    }

    /// Settings for the next registration.
    pub(crate) fn set_settings(&mut self, settings: serde_json::Value) {
        self.registration.settings = settings;
    }

    /// The link, where it is registered.
    pub(crate) fn current(&mut self) -> Option<&mut Link> {
        match &mut self.state {
            State::Live(link) => Some(link),
            State::Pending(_) | State::Lost => None,
        }
    }

    /// The link; registers again where a daemon went away, up to the deadline.
    pub(crate) fn live(&mut self, deadline: Instant) -> Result<&mut Link, PublishError> {
        loop {
            match &self.state {
                State::Live(_) => {
                    if !self.lose_if_gone() {
                        break;
                    }
                }
                State::Lost => self.send_registration(deadline)?,
                State::Pending(_) => self.poll_registration(deadline)?,
            }
        }
        self.current().ok_or(PublishError::Reconnecting)
    }

    /// Gives the link up where its daemon is gone, and says whether it did.
    pub(crate) fn lose_if_gone(&mut self) -> bool {
        let is_gone = self.current().is_some_and(Link::is_gone);
        if is_gone {
            tracing::warn!(domain = self.connection.domain.name(), "the untangled daemon went away");
            self.state = State::Lost;
        }
        is_gone
    }

    /// Asks the daemon to end the session; nothing to do where it does not know it any more.
    pub(crate) fn close(&mut self, deadline: Instant) -> Result<(), RequestError> {
        let Some(link) = self.current() else { return Ok(()) };
        if link.is_closed() || link.is_dead() {
            return Ok(());
        }
        let session = link.session;
        let closed = Pending::send(&self.connection, RequestKind::Close, session, &[], 0)
            .and_then(|pending| pending.wait(&self.connection, deadline).map(drop));
        // It is not asked a second time when this is dropped.
        self.state = State::Lost;
        closed
    }

    fn send_registration(&mut self, deadline: Instant) -> Result<(), PublishError> {
        let (payload, num_sections) = self.registration.encode();
        match Pending::send(&self.connection, RequestKind::Register, 0, &payload, num_sections) {
            Ok(pending) => self.state = State::Pending(Box::new(pending)),
            // The transport fails while a dead daemon is being cleaned up, or a new one starts.
            Err(error) if error.may_pass() => sleep_or_give_up(deadline)?,
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    fn poll_registration(&mut self, deadline: Instant) -> Result<(), PublishError> {
        let State::Pending(pending) = &self.state else { return Ok(()) };
        match pending.poll(&self.connection, deadline) {
            Ok(Some(reply)) => return self.open_link(&reply),
            // A daemon that died with the request never answers: ask the next one.
            Ok(None) if pending.sent.elapsed() > self.connection.timeout => {}
            Ok(None) => return Err(PublishError::Reconnecting),
            Err(error) if error.may_pass() => {}
            Err(error) => {
                self.state = State::Lost;
                return Err(error.into());
            }
        }
        self.state = State::Lost;
        Ok(())
    }

    fn open_link(&mut self, reply: &Reply) -> Result<(), PublishError> {
        let connection = &self.connection;
        let link = Link::open(&connection.node, &connection.domain, reply, &self.registration, connection.layout);
        self.state = State::Lost;
        match link {
            // That daemon is gone as well.
            Err(RequestError::Transport { .. }) => return Ok(()),
            link => {
                let link = link?;
                (self.options, self.num_welded) = (link.corrections.options(), link.num_welded);
                self.state = State::Live(Box::new(link));
            }
        }
        self.num_registrations += 1;
        tracing::info!(num_registrations = self.num_registrations, "the session is registered again");
        Ok(())
    }
}

impl Drop for ReconnectingLink {
    fn drop(&mut self) {
        // The daemon may not have seen the ports of a young session, and would wait for them.
        let young = self.current().filter(|link| link.opened.elapsed() < SEEN).map(|link| link.session);
        if let Some(session) = young
            && let Ok(pending) = Pending::send(&self.connection, RequestKind::Close, session, &[], 0)
        {
            let _ = pending.poll(&self.connection, Instant::now() + CLOSE);
        }
        self.state = State::Lost;
        // The daemon checks its sessions whenever it is woken.
        self.connection.wake(names::EVENT_STATE);
    }
}

fn sleep_or_give_up(deadline: Instant) -> Result<(), PublishError> {
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Err(PublishError::Reconnecting);
    }
    std::thread::sleep(left.min(Duration::from_millis(10)));
    Ok(())
}
