//! Requests: each gets one reply, a refusal included.

use std::{
    collections::hash_map::RandomState,
    hash::BuildHasher,
    time::{Duration, Instant},
};

use iceoryx2::{
    active_request::ActiveRequest,
    port::{notifier::Notifier, server::Server},
    prelude::{AllocationStrategy, EventId, Node},
};
use untangled_proto::{
    ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, Status,
    control::Hello,
    names,
    sections::Sections,
    services::{self, Control, Event, Ipc},
};

use super::{
    ServeOptions,
    error::{Refusal, ServeError},
    register,
    session::Session,
    status,
};

type Port = Server<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;
type Request = ActiveRequest<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// What a request asked for.
struct Answer {
    session: u64,
    text: String,
}

/// Answers requests. Fields are dropped in order: ports before services.
pub(super) struct ControlServer<'a> {
    server: Port,
    notifier: Notifier<Ipc>,
    _service: Control,
    _event: Event,
    options: &'a ServeOptions,
    /// Tells this run of the daemon from any other.
    instance: u64,
    num_registered: u64,
    started: Instant,
}

impl<'a> ControlServer<'a> {
    pub(super) fn start(node: &Node<Ipc>, options: &'a ServeOptions) -> Result<Self, ServeError> {
        let event = services::create_shared_event(node, names::REPLY)
            .map_err(|error| ServeError::transport("creating the reply event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
        let (service, server) = create_server(node)?;
        Ok(Self {
            server,
            notifier,
            _service: service,
            _event: event,
            options,
            instance: RandomState::new().hash_one(std::process::id()),
            num_registered: 0,
            started: Instant::now(),
        })
    }

    /// Answers all requests that have come.
    pub(super) fn answer(&mut self, node: &Node<Ipc>, sessions: &mut Vec<Session>) {
        loop {
            let request = match self.server.receive() {
                Ok(Some(request)) => request,
                Ok(None) => return,
                Err(error) => {
                    tracing::warn!(?error, "receiving a request");
                    return;
                }
            };
            // A copy: the peer may write on.
            let header = *request.user_header();
            let answer = self.answer_one(node, sessions, &header, request.payload());
            if let Err(refusal) = &answer {
                tracing::info!(kind = header.kind, status = ?refusal.status, reason = %refusal, "request refused");
            }
            if let Err(error) = self.reply(&request, answer) {
                // Most likely its client is gone, and a session that it registered goes with the next housekeeping.
                tracing::info!(?error, "sending a reply");
            }
        }
    }

    fn answer_one(
        &mut self,
        node: &Node<Ipc>,
        sessions: &mut Vec<Session>,
        header: &RequestHeader,
        payload: &[u8],
    ) -> Result<Answer, Refusal> {
        if header.protocol_version != PROTOCOL_VERSION {
            let theirs = header.protocol_version;
            return Err(Refusal::new(
                Status::UnsupportedProtocol,
                format_args!(
                    "the client speaks protocol {theirs}, this daemon {PROTOCOL_VERSION} (untangled {LIBRARY_VERSION})"
                ),
            ));
        }
        let kind = RequestKind::from_code(header.kind).ok_or_else(|| {
            Refusal::new(Status::BadRequest, format_args!("there is no request of kind {}", header.kind))
        })?;
        let num_sections = usize::try_from(header.num_sections).unwrap_or(usize::MAX);
        let sections =
            Sections::parse(payload, num_sections).map_err(|error| Refusal::new(Status::BadRequest, error))?;
        let plain = |text: String| Ok(Answer { session: 0, text });
        match kind {
            RequestKind::Hello => plain(json(&Hello {
                protocol_version: PROTOCOL_VERSION,
                library_version: LIBRARY_VERSION.to_owned(),
                iceoryx2_version: ICEORYX2_VERSION.to_owned(),
                pid: std::process::id(),
            })),
            RequestKind::Status => plain(json(&status::report(self.options, self.started.elapsed(), sessions))),
            RequestKind::Register => self.register(node, sessions, &sections),
            RequestKind::UpdateSettings => {
                let settings = register::settings(&sections, self.options)?;
                find(sessions, header.session)?.set_settings(settings)?;
                plain(String::new())
            }
            RequestKind::Close => {
                let id = find(sessions, header.session)?.id();
                sessions.retain(|session| session.id() != id);
                tracing::info!(session = id, "session closed");
                plain(String::new())
            }
        }
    }

    fn register(
        &mut self,
        node: &Node<Ipc>,
        sessions: &mut Vec<Session>,
        sections: &Sections<'_>,
    ) -> Result<Answer, Refusal> {
        let limit = self.options.max_sessions;
        if sessions.len() >= limit {
            return Err(Refusal::new(Status::TooManySessions, format_args!("{limit} sessions are open already")));
        }
        let reserved = sessions.iter().map(Session::untouched_bytes).sum();
        let registered = register::read(sections, self.options, reserved)?;
        let id = self.num_registered + 1;
        let session = Session::create(node, self.instance, id, registered)?;
        tracing::info!(
            session = id,
            num_vertices = session.mesh().num_vertices(),
            num_faces = session.mesh().num_faces(),
            "session registered"
        );
        self.num_registered = id;
        sessions.push(session);
        Ok(Answer { session: id, text: String::new() })
    }

    fn reply(&self, request: &Request, answer: Result<Answer, Refusal>) -> Result<(), ServeError> {
        let (status, session, text) = match answer {
            Ok(answer) => (Status::Ok, answer.session, answer.text),
            Err(refusal) => (refusal.status, 0, refusal.message),
        };
        let mut reply =
            request.loan_slice_uninit(text.len()).map_err(|error| ServeError::transport("loaning a reply", &error))?;
        *reply.user_header_mut() = ReplyHeader {
            protocol_version: PROTOCOL_VERSION,
            status: status.code(),
            instance: self.instance,
            session,
            ..ReplyHeader::default()
        };
        let reply = reply.write_from_slice(text.as_bytes());
        reply.send().map_err(|error| ServeError::transport("sending a reply", &error))?;
        // A listener that can't be reached is a client that is gone.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY));
        Ok(())
    }
}

/// The control service with its one server. A server of a daemon that was killed counts until it is cleaned up.
fn create_server(node: &Node<Ipc>) -> Result<(Control, Port), ServeError> {
    const ATTEMPTS: u32 = 20;
    let mut attempt = 0;
    loop {
        attempt += 1;
        let result = services::create_control(node)
            .map_err(|error| ServeError::transport("creating the control service", &error))
            .and_then(|service| {
                let server = service
                    .server_builder()
                    .initial_max_slice_len(4096)
                    .allocation_strategy(AllocationStrategy::PowerOfTwo)
                    .max_loaned_responses_per_request(1)
                    .create()
                    .map_err(|error| ServeError::transport("creating the control server", &error))?;
                Ok((service, server))
            });
        match result {
            Ok(created) => return Ok(created),
            Err(error) if attempt == ATTEMPTS => return Err(error),
            Err(error) => {
                tracing::debug!(%error, attempt, "trying again");
                std::thread::sleep(Duration::from_millis(100));
                let _ = node.try_cleanup_dead_nodes();
            }
        }
    }
}

fn find(sessions: &mut [Session], id: u64) -> Result<&mut Session, Refusal> {
    sessions
        .iter_mut()
        .find(|session| session.id() == id)
        .ok_or_else(|| Refusal::new(Status::UnknownSession, format_args!("there is no session {id}")))
}

fn json(value: &impl serde::Serialize) -> String {
    // Plain structs of numbers and text: nothing in them can fail to serialise.
    serde_json::to_string(value).unwrap_or_default()
}
