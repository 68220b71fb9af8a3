//! Requests: each gets one reply, a refusal included.

use std::{sync::Arc, time::Duration};

use iceoryx2::{
    active_request::ActiveRequest,
    port::{notifier::Notifier, server::Server},
    prelude::{AllocationStrategy, EventId, Node},
};
use untangled_proto::{ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, Status, control::Hello, names, sections::Sections};
use untangled_transport::{memory, services::{self, Control, Event, Ipc}};

use super::{
    error::{Refusal, ServeError},
    register,
    registry::Registry,
    status,
    throttle::Throttle,
};

type Port = Server<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;
type Request = ActiveRequest<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// Room for a reply at the start.
const REPLY_BYTES: usize = 4096;

/// Replies on their way at a time for which shared memory is taken at the start: one for each client, and as many again.
const COMMITTED_REPLIES: u64 = 2 * untangled_proto::limits::MAX_CLIENTS as u64;
/// Registrations of more bytes than this are large.
const LARGE_BYTES: usize = 1 << 20;

/// What a request asked for.
struct Answer {
    session: u64,
    text: String,
}

/// Receives requests and answers those that take no time. Fields are dropped in order: ports before services.
pub(super) struct ControlServer {
    server: Port,
    replier: Arc<Replier>,
    _service: Control,
    _event: Event,
}

/// Sends replies, from any thread.
#[derive(Debug)]
struct Replier {
    notifier: Notifier<Ipc>,
    registry: Arc<Registry>,
}

/// A registration, for a worker: a mesh may be large.
#[derive(Debug)]
pub(super) struct RegistrationJob {
    request: Request,
    header: RequestHeader,
    replier: Arc<Replier>,
}

impl ControlServer {
    pub(super) fn start(node: &Node<Ipc>, registry: Arc<Registry>) -> Result<Self, ServeError> {
        let event = services::create_shared_event(node, names::REPLY)
            .map_err(|error| ServeError::transport("creating the reply event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| ServeError::transport("creating a notifier", &error))?;
        let (service, server) = create_server(node)?;
        // Refusals must get through where shared memory is full.
        let domain = &registry.options().domain;
        memory::commit_first(domain, server.id().value(), COMMITTED_REPLIES * REPLY_BYTES as u64)
            .map_err(|source| ServeError::System { what: "taking shared memory for replies", source })?;
        Ok(Self { server, replier: Arc::new(Replier { notifier, registry }), _service: service, _event: event })
    }

    /// Answers all requests that have come, but for registrations: those are for `defer`.
    pub(super) fn answer(&self, mut defer: impl FnMut(RegistrationJob)) {
        loop {
            let request = match self.server.receive() {
                Ok(Some(request)) => request,
                Ok(None) => return,
                Err(error) => {
                    static FAILED: Throttle = Throttle::new();
                    if let Some(num_suppressed) = FAILED.admit() {
                        tracing::warn!(?error, num_suppressed, "receiving a request");
                    }
                    return;
                }
            };
            // A copy: the peer may write on.
            let header = *request.user_header();
            let replier = &self.replier;
            if header.kind == RequestKind::Register as u32 && header.protocol_version == PROTOCOL_VERSION {
                defer(RegistrationJob { request, header, replier: Arc::clone(replier) });
            } else {
                replier.reply(&request, &header, replier.answer(&header, request.payload()));
            }
        }
    }
}

impl RegistrationJob {
    /// Whether reading it may take so long that small sessions must not wait for it.
    pub(super) fn is_large(&self) -> bool {
        self.request.payload().len() > LARGE_BYTES
    }

    pub(super) fn run(self) {
        let Self { request, header, replier } = self;
        replier.reply(&request, &header, replier.register(&header, request.payload()));
    }
}

impl Replier {
    fn answer(&self, header: &RequestHeader, payload: &[u8]) -> Result<Answer, Refusal> {
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
        let sections = sections(header, payload)?;
        let plain = |text: String| Ok(Answer { session: 0, text });
        match kind {
            RequestKind::Hello => plain(json(&Hello {
                protocol_version: PROTOCOL_VERSION,
                library_version: LIBRARY_VERSION.to_owned(),
                iceoryx2_version: ICEORYX2_VERSION.to_owned(),
                pid: std::process::id(),
            })),
            RequestKind::Status => plain(json(&status::report(&self.registry))),
            RequestKind::Register => self.register(header, payload),
            RequestKind::UpdateSettings => {
                let settings = register::settings(&sections, self.registry.options())?;
                self.registry.find(header.session)?.set_settings(settings)?;
                plain(String::new())
            }
            RequestKind::Close => {
                self.registry.close(header.session)?;
                plain(String::new())
            }
        }
    }

    fn register(&self, header: &RequestHeader, payload: &[u8]) -> Result<Answer, Refusal> {
        let session = self.registry.register(&sections(header, payload)?)?;
        Ok(Answer { session, text: String::new() })
    }

    fn reply(&self, request: &Request, header: &RequestHeader, answer: Result<Answer, Refusal>) {
        if let Err(refusal) = &answer {
            static REFUSED: Throttle = Throttle::new();
            self.registry.count_refused_request();
            if let Some(num_suppressed) = REFUSED.admit() {
                let (kind, status) = (header.kind, refusal.status);
                tracing::info!(kind, ?status, reason = %refusal, num_suppressed, "request refused");
            }
        }
        if let Err(error) = self.send(request, header.token, answer) {
            // Most likely its client is gone, and a session that it registered goes with the next housekeeping.
            static LOST: Throttle = Throttle::new();
            if let Some(num_suppressed) = LOST.admit() {
                tracing::info!(%error, num_suppressed, "sending a reply");
            }
        }
    }

    fn send(&self, request: &Request, token: [u64; 2], answer: Result<Answer, Refusal>) -> Result<(), ServeError> {
        let (status, session, text) = match answer {
            Ok(answer) => (Status::Ok, answer.session, answer.text),
            Err(refusal) => (refusal.status, 0, refusal.message),
        };
        check_room(text.len())?;
        let mut reply =
            request.loan_slice_uninit(text.len()).map_err(|error| ServeError::transport("loaning a reply", &error))?;
        *reply.user_header_mut() = ReplyHeader {
            protocol_version: PROTOCOL_VERSION,
            status: status.code(),
            instance: self.registry.instance(),
            session,
            token,
            ..ReplyHeader::default()
        };
        let reply = reply.write_from_slice(text.as_bytes());
        reply.send().map_err(|error| ServeError::transport("sending a reply", &error))?;
        // A listener that can't be reached is a client that is gone.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY));
        Ok(())
    }
}

fn sections<'a>(header: &RequestHeader, payload: &'a [u8]) -> Result<Sections<'a>, Refusal> {
    let num_sections = usize::try_from(header.num_sections).unwrap_or(usize::MAX);
    Sections::parse(payload, num_sections).map_err(|error| Refusal::new(Status::BadRequest, error))
}

/// Whether a reply that is longer than the room at the start may be written: its segment grows then, and a full one is SIGBUS.
fn check_room(reply_bytes: usize) -> Result<(), ServeError> {
    // Twice, since segments grow by powers of two, and for each of the samples that a server keeps for its clients.
    let needed = (reply_bytes as u64 * 2).saturating_mul(4 * untangled_proto::limits::MAX_CLIENTS as u64);
    if reply_bytes > REPLY_BYTES && memory::free().is_ok_and(|free| free < needed) {
        return Err(ServeError::transport("loaning a reply", &"shared memory is full"));
    }
    Ok(())
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
                    .initial_max_slice_len(REPLY_BYTES)
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

fn json(value: &impl serde::Serialize) -> String {
    // Plain structs of numbers and text: nothing in them can fail to serialise.
    serde_json::to_string(value).unwrap_or_default()
}
