//! Replies: answers a request and sends the reply.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use iceoryx2::{active_request::ActiveRequest, port::notifier::Notifier, prelude::EventId};
use untangled_proto::{
    ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, SessionOptions,
    Status,
    control::{BODY, Hello, OBSERVE},
    limits::{MAX_NAME_BYTES, MAX_PART_BYTES},
    memory::{PayloadLayout, reply_sample_bytes},
    names,
    sections::{Sections, id},
};
use untangled_transport::{memory, process_id::ProcessId, services::Ipc, throttle::Throttle};

use super::{registration, registry::Registry, status};
use crate::service::{
    error::{Refusal, ServeError},
    session::NewObserver,
};

/// A request that has not been replied to.
pub(crate) type Request = ActiveRequest<Ipc, [u8], RequestHeader, [u8], ReplyHeader>;

/// Room for a reply at the start. Refusals fit; longer reports make the samples grow.
pub(crate) const REPLY_BYTES: usize = 2048;

/// The content of a reply that is no refusal.
#[derive(Default)]
struct Answer {
    session: u64,
    num_body_vertices: u64,
    num_places: u64,
    /// Of the whole of which the payload is a part, where it is no text.
    num_bytes: u64,
    payload: Vec<u8>,
}

/// Sends replies, from any thread.
#[derive(Debug)]
pub(crate) struct Replier {
    notifier: Notifier<Ipc>,
    registry: Arc<Registry>,
    /// Whether a reply was longer than there is committed room for: the samples of all later ones are longer as well,
    /// and their pages are not taken before they are written to.
    has_grown: AtomicBool,
}

impl Replier {
    pub(crate) fn new(notifier: Notifier<Ipc>, registry: Arc<Registry>) -> Self {
        Self { notifier, registry, has_grown: AtomicBool::new(false) }
    }

    /// Does what a request asks for, and replies.
    pub(crate) fn answer(&self, request: &Request, header: &RequestHeader, layout: PayloadLayout) {
        self.reply(request, header, layout, self.execute(header, request, layout));
    }

    fn execute(&self, header: &RequestHeader, request: &Request, layout: PayloadLayout) -> Result<Answer, Refusal> {
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
        let sections = sections(header, request.payload())?;
        let plain = |text: String| Ok(Answer { payload: text.into_bytes(), ..Answer::default() });
        match kind {
            RequestKind::Hello => plain(json(&Hello {
                protocol_version: PROTOCOL_VERSION,
                library_version: LIBRARY_VERSION.to_owned(),
                iceoryx2_version: ICEORYX2_VERSION.to_owned(),
                pid: std::process::id(),
                features: features(),
            })),
            RequestKind::Status => plain(json(&status::report(&self.registry))),
            RequestKind::Register => self.open_session(&sections, request, layout),
            RequestKind::UpdateSettings => {
                let settings = registration::settings(&sections, self.registry.options())?;
                self.registry.find(header.session)?.set_settings(settings)?;
                plain(String::new())
            }
            RequestKind::Close => {
                self.registry.close(header.session)?;
                plain(String::new())
            }
            RequestKind::Observe => {
                let session = self.registry.find(header.session)?;
                // One that fetches the rest of a mesh has been counted.
                if is_first_part(&sections) || session.num_observers().is_none() {
                    let asked_by = ProcessId::of(request.origin().value());
                    let (registry, name) = (&*self.registry, observer_name(&sections)?);
                    let observer = NewObserver { node: registry.node(), instance: registry.instance(), asked_by, name };
                    registry.audience().admit(|| registry.sessions().clone(), &session, observer)?;
                }
                let mesh = session.mesh_for_observers();
                let payload = part(mesh, &sections)?.to_vec();
                Ok(Answer { payload, num_bytes: mesh.len() as u64, ..Answer::default() })
            }
        }
    }

    fn open_session(
        &self,
        sections: &Sections<'_>,
        request: &Request,
        layout: PayloadLayout,
    ) -> Result<Answer, Refusal> {
        let client = ProcessId::of(request.origin().value());
        let (session, cloth) = self.registry.register(sections, layout, client)?;
        let num_body_vertices = cloth.num_body_vertices() as u64;
        let num_places = cloth.weld().map_or(0, |_| cloth.mesh().num_vertices() as u64);
        Ok(Answer { session, num_body_vertices, num_places, ..Answer::default() })
    }

    fn reply(&self, request: &Request, header: &RequestHeader, layout: PayloadLayout, answer: Result<Answer, Refusal>) {
        if let Err(refusal) = &answer {
            static REFUSED: Throttle = Throttle::new();
            self.registry.count_refused_request();
            if let Some(num_suppressed) = REFUSED.admit() {
                let (kind, status) = (header.kind, refusal.status.words());
                tracing::info!(kind, status, reason = %refusal, num_suppressed, "request refused");
            }
        }
        if let Err(error) = self.send(request, header.token, layout, answer) {
            // Most likely the client is gone; a session that it registered ends when no host comes.
            static LOST: Throttle = Throttle::new();
            if let Some(num_suppressed) = LOST.admit() {
                tracing::info!(%error, num_suppressed, "sending a reply");
            }
        }
    }

    fn send(
        &self,
        request: &Request,
        token: [u64; 2],
        layout: PayloadLayout,
        answer: Result<Answer, Refusal>,
    ) -> Result<(), ServeError> {
        let (status, answer) = match answer {
            Ok(answer) => (Status::Ok, answer),
            Err(refusal) => (refusal.status, Answer { payload: refusal.message.into_bytes(), ..Answer::default() }),
        };
        let Answer { session, num_body_vertices, num_places, num_bytes, payload } = answer;
        let has_grown = self.has_grown.fetch_or(payload.len() > REPLY_BYTES, Ordering::Relaxed);
        check_room(payload.len(), layout, has_grown)?;
        let mut reply = request
            .loan_slice_uninit(payload.len())
            .map_err(|error| ServeError::transport("loaning a reply", &error))?;
        *reply.user_header_mut() = ReplyHeader {
            protocol_version: PROTOCOL_VERSION,
            status: status.code(),
            instance: self.registry.instance(),
            session,
            token,
            num_body_vertices,
            num_places,
            num_bytes,
        };
        let reply = reply.write_from_slice(&payload);
        reply.send().map_err(|error| ServeError::transport("sending a reply", &error))?;
        // An error means that the client is gone.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY));
        Ok(())
    }
}

fn sections<'a>(header: &RequestHeader, payload: &'a [u8]) -> Result<Sections<'a>, Refusal> {
    let num_sections = usize::try_from(header.num_sections).unwrap_or(usize::MAX);
    Sections::parse(payload, num_sections).map_err(|error| Refusal::new(Status::BadRequest, error))
}

/// Whether shared memory has room for a reply that is longer than [`REPLY_BYTES`], or comes after one: the segment has
/// grown then, and writing to a page that the system can't provide ends the process with SIGBUS.
fn check_room(length: usize, layout: PayloadLayout, has_grown: bool) -> Result<(), ServeError> {
    // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
    let needed = reply_sample_bytes(2 * length, layout);
    if (has_grown || length > REPLY_BYTES) && memory::free().is_ok_and(|free| free < needed) {
        return Err(ServeError::NoRoom { what: "loaning a reply" });
    }
    Ok(())
}

/// What this daemon knows beyond what protocol 1 began with.
fn features() -> Vec<String> {
    SessionOptions::NAMES.iter().map(|(name, _)| *name).chain([BODY, OBSERVE]).map(str::to_owned).collect()
}

/// What an observer is called.
fn observer_name(sections: &Sections<'_>) -> Result<Option<String>, Refusal> {
    let Some(bytes) = sections.bytes(id::NAME) else { return Ok(None) };
    let refused = |words: std::fmt::Arguments<'_>| Err(Refusal::new(Status::BadRequest, words));
    if bytes.len() > MAX_NAME_BYTES {
        return refused(format_args!(
            "section 12 (name) has {} bytes; at most {MAX_NAME_BYTES} are allowed",
            bytes.len()
        ));
    }
    // Copied first: the peer may go on writing.
    match String::from_utf8(bytes.to_vec()) {
        Ok(name) if !name.contains(char::is_control) => Ok(Some(name)),
        _ => refused(format_args!("section 12 (name) must be UTF-8 without control characters")),
    }
}

/// Whether an observer asks for a mesh from its beginning on.
fn is_first_part(sections: &Sections<'_>) -> bool {
    sections.bytes(id::FROM).is_none_or(|from| from.iter().all(|&byte| byte == 0))
}

/// The part of a mesh that an observer asks for.
fn part<'a>(mesh: &'a [u8], sections: &Sections<'_>) -> Result<&'a [u8], Refusal> {
    let from = match sections.bytes(id::FROM) {
        None => Ok(0),
        Some(bytes) => bytes.try_into().map(u64::from_le_bytes),
    };
    let rest = from.ok().and_then(|from| mesh.get(usize::try_from(from).ok()?..)).ok_or_else(|| {
        let message = format_args!("section 13 (from) must be a number of 8 bytes, at most {}", mesh.len());
        Refusal::new(Status::BadRequest, message)
    })?;
    Ok(&rest[..rest.len().min(MAX_PART_BYTES)])
}

fn json(value: &impl serde::Serialize) -> String {
    // Structs of numbers and text always serialise.
    serde_json::to_string(value).unwrap_or_default()
}
