//! The way of a request: from a host to a daemon elsewhere, and the reply back.

use std::{
    sync::{Arc, atomic::Ordering},
    time::{Duration, Instant},
};

use iceoryx2::prelude::EventId;
use untangled_proto::{
    PROTOCOL_VERSION, PayloadLayout, ReplyHeader, RequestHeader, RequestKind, Status, limits,
    memory::reply_sample_bytes, names, sections::Sections,
};
use untangled_transport::memory;
use zenoh::{Wait, query::ConsolidationMode};

use super::{
    front::{Pending, REPLY_BYTES},
    ports::{DownPorts, Shape, StatePort},
    refusal::Refusal,
    session::{Remote, Session},
    shared::Shared,
    status,
};
use crate::{
    metrics::count,
    net::{Outlet, Urgency},
    throttle::Throttle,
    wire::{
        keys,
        request::{Reply, Request, Services},
    },
};

/// Longest time that a daemon end may take for a registration, and for another request.
const REGISTRATION: Duration = Duration::from_secs(60);
const OTHER: Duration = Duration::from_secs(5);
/// Time until a request that no daemon has answered is asked again.
const RETRY: Duration = Duration::from_millis(20);

/// The content of a reply.
struct Answer {
    header: ReplyHeader,
    payload: Vec<u8>,
}

/// Why there is no answer.
enum Failure {
    /// The host is told.
    Refused(Refusal),
    /// No daemon is there: the host finds none, and tries again.
    NoDaemon,
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

/// Passes a request on, and replies. For a thread that may wait.
///
/// A request that no daemon answers is asked again: a client waits for its reply for as long as the server is the same,
/// and it is while another daemon, or the next run of this one, serves.
pub(crate) fn serve(shared: &Arc<Shared>, pending: &Pending, header: &RequestHeader, layout: PayloadLayout) {
    count(&shared.metrics.num_requests);
    // A copy: the peer may go on writing.
    let payload = pending.payload().to_vec();
    let (begin, opening) = (Instant::now(), shared.num_openings.load(Ordering::Relaxed));
    let answer = loop {
        match ask_for(shared, header, &payload, layout) {
            Ok(answer) => break answer,
            Err(Failure::Refused(refusal)) => break refused(shared, refusal),
            Err(Failure::NoDaemon) => {
                let is_open = shared.num_openings.load(Ordering::Relaxed) == opening;
                if !is_open || !pending.is_connected() || begin.elapsed() > REGISTRATION {
                    // The host finds no daemon, or has given up.
                    return tracing::debug!(kind = header.kind, "no daemon has answered a request");
                }
                std::thread::sleep(RETRY);
            }
        }
    };
    reply(shared, pending, header.token, layout, &answer);
}

/// Refuses a request for which there is no thread.
pub(crate) fn refuse(shared: &Shared, pending: &Pending, header: &RequestHeader, layout: PayloadLayout) {
    let refusal = Refusal::new(Status::TooManySessions, "too many requests are on their way to daemons already");
    reply(shared, pending, header.token, layout, &refused(shared, refusal));
}

fn refused(shared: &Shared, refusal: Refusal) -> Answer {
    count(&shared.metrics.num_refused_requests);
    let header = ReplyHeader { status: refusal.status.code(), ..ReplyHeader::default() };
    Answer { header, payload: refusal.message.into_bytes() }
}

fn reply(shared: &Shared, pending: &Pending, token: [u64; 2], layout: PayloadLayout, answer: &Answer) {
    if let Err(reason) = send(shared, pending, token, layout, answer) {
        static LOST: Throttle = Throttle::new();
        if let Some(num_suppressed) = LOST.admit() {
            // Most likely the client is gone; a session that it registered ends when no host comes.
            tracing::info!(reason, num_suppressed, "sending a reply");
        }
    }
}

fn ask_for(
    shared: &Arc<Shared>,
    header: &RequestHeader,
    payload: &[u8],
    layout: PayloadLayout,
) -> Result<Answer, Failure> {
    if header.protocol_version != PROTOCOL_VERSION {
        return to_any(shared, header, payload);
    }
    match RequestKind::from_code(header.kind) {
        Some(RequestKind::Register) => register(shared, header, payload, layout),
        Some(RequestKind::UpdateSettings | RequestKind::Close) => to_session(shared, header, payload),
        Some(RequestKind::Observe) => {
            // Views do not cross the network, and a session here has another id there.
            let message = "a session can't be watched through a bridge; watch it on the machine of its daemon";
            Err(Refusal::new(Status::BadRequest, message).into())
        }
        Some(RequestKind::Status) => {
            let Answer { header, payload } = to_any(shared, header, payload)?;
            let (payload, header) = status::add(shared, payload, header);
            Ok(Answer { header, payload })
        }
        _ => to_any(shared, header, payload),
    }
}

/// Asks one daemon end.
fn ask(shared: &Shared, daemon: &str, request: &Request<'_>) -> Option<Reply> {
    let time = if request.header.kind == RequestKind::Register as u32 { REGISTRATION } else { OTHER };
    let replies = shared
        .network
        .get(keys::requests(daemon, &shared.name))
        .payload(request.to_bytes())
        .congestion_control(Urgency::Data.congestion())
        .priority(Urgency::Data.priority())
        .consolidation(ConsolidationMode::None)
        .timeout(time)
        .wait();
    let replies = match replies {
        Ok(replies) => replies,
        Err(error) => {
            tracing::debug!(%error, daemon, "asking a daemon end");
            return None;
        }
    };
    let reply = replies.recv().ok()?;
    let sample = reply.into_result().ok()?;
    Reply::read(&sample.payload().to_bytes())
}

/// Asks the least loaded daemon, and the next one where that does not answer.
fn ask_any(shared: &Shared, request: &Request<'_>) -> Result<(Remote, Reply), Failure> {
    let mut tried = Vec::new();
    while let Some((daemon, runs)) = shared.directory.choose(&tried) {
        match ask(shared, &daemon, request) {
            Some(Reply::Refused(words)) => return Err(Refusal::new(Status::TooManySessions, words).into()),
            Some(reply @ Reply::Answered { .. }) => return Ok((Remote { daemon, runs, session: 0 }, reply)),
            Some(Reply::NoDaemon(words)) => {
                tracing::info!(daemon = &*daemon, words, "a daemon end has no daemon");
                shared.directory.has_no_daemon(&daemon);
            }
            None => {}
        }
        tried.push(daemon);
    }
    Err(Failure::NoDaemon)
}

fn to_any(shared: &Shared, header: &RequestHeader, payload: &[u8]) -> Result<Answer, Failure> {
    match ask_any(shared, &Request { link: 0, header: *header, payload })? {
        (_, Reply::Answered { header, payload, .. }) => Ok(Answer { header, payload }),
        _ => Err(Failure::NoDaemon),
    }
}

/// An update or a close.
fn to_session(shared: &Shared, header: &RequestHeader, payload: &[u8]) -> Result<Answer, Failure> {
    let id = header.session;
    let unknown = || Refusal::new(Status::UnknownSession, format_args!("there is no session {id}"));
    let session = shared.sessions.by_id(id).ok_or_else(unknown)?;
    let header = RequestHeader { session: session.remote.session, ..*header };
    let request = Request { link: session.link, header, payload };
    match ask(shared, &session.remote.daemon, &request) {
        Some(Reply::Answered { header, payload, .. }) => {
            if header.status == Status::UnknownSession.code() {
                return Err(unknown().into());
            }
            if request.header.kind == RequestKind::Close as u32 && header.status == Status::Ok.code() {
                shared.sessions.remove_where(|other| other.id == id);
                session.end();
            }
            Ok(Answer { header, payload })
        }
        Some(Reply::Refused(words)) => Err(Refusal::new(Status::BadRequest, words).into()),
        Some(Reply::NoDaemon(_)) | None => {
            // As by the next run of a daemon that went away.
            session.end();
            Err(unknown().into())
        }
    }
}

fn register(
    shared: &Arc<Shared>,
    header: &RequestHeader,
    payload: &[u8],
    layout: PayloadLayout,
) -> Result<Answer, Failure> {
    if shared.sessions.len() >= limits::MAX_SESSIONS {
        let words = format!("{} sessions are open already", limits::MAX_SESSIONS);
        return Err(Refusal::new(Status::TooManySessions, words).into());
    }
    check_length(shared, "registration", payload.len())?;
    let link = shared.new_link();
    let (mut remote, reply) = ask_any(shared, &Request { link, header: *header, payload })?;
    let Reply::Answered { services, header: mut reply, payload: words } = reply else { return Err(Failure::NoDaemon) };
    if reply.status != Status::Ok.code() {
        return Ok(Answer { header: reply, payload: words });
    }
    remote.session = reply.session;
    let id = shared.num_registered.fetch_add(1, Ordering::Relaxed) + 1;
    match open(shared, header, payload, layout, services, [id, link], &remote) {
        Ok(session) => {
            shared.directory.add_faces(&remote.daemon, session.num_faces);
            static REGISTERED: Throttle = Throttle::new();
            if let Some(num_suppressed) = REGISTERED.admit() {
                let daemon = &*remote.daemon;
                tracing::info!(session = id, daemon, remote_session = remote.session, num_suppressed, "registered");
            }
        }
        Err(refusal) => {
            shared.close(link, &remote);
            return Err(refusal.into());
        }
    }
    (reply.instance, reply.session) = (shared.instance, id);
    Ok(Answer { header: reply, payload: words })
}

/// Whether a message has a length that the other end takes.
fn check_length(shared: &Shared, what: &str, length: usize) -> Result<(), Refusal> {
    // Headers of all kinds take less.
    const HEADERS: usize = 1024;
    if length.saturating_add(HEADERS) <= shared.max_message_bytes {
        return Ok(());
    }
    let most = shared.max_message_bytes;
    let words = format!("a {what} of {length} bytes; the bridge takes {most} (limits.max_message_mb)");
    Err(Refusal::new(Status::TooLarge, words))
}

/// Makes the ports of a session that a daemon has accepted.
fn open(
    shared: &Arc<Shared>,
    header: &RequestHeader,
    payload: &[u8],
    layout: PayloadLayout,
    services: Services,
    [id, link]: [u64; 2],
    remote: &Remote,
) -> Result<Arc<Session>, Refusal> {
    let num_sections = usize::try_from(header.num_sections).unwrap_or(usize::MAX);
    let shape = Sections::parse(payload, num_sections)
        .ok()
        .and_then(|sections| Shape::read(&shared.domain, &sections, layout, services, [shared.instance, id]))
        .ok_or_else(|| Refusal::new(Status::Internal, "a daemon took a registration that this bridge can't read"))?;
    check_length(shared, "state", shape.state_bytes())?;
    shape.check_memory()?;
    let states = StatePort::create(&shared.node, &shape)?;
    let down = DownPorts::create(&shared.node, &shape)?;
    let key = keys::up(&remote.daemon, &shared.name, &keys::link(link));
    let metrics = Arc::clone(&shared.metrics);
    let outlet = Outlet::new(&shared.network, &key, link, Arc::clone(&metrics))
        .map_err(|error| Refusal::new(Status::Internal, error))?;
    let session = Session::new([id, link, shape.num_faces], remote.clone(), states, down, outlet, metrics);
    let session = Arc::new(session);
    session
        .start()
        .map_err(|error| Refusal::new(Status::Internal, format_args!("starting a thread of a session: {error}")))?;
    shared.sessions.insert(Arc::clone(&session));
    Ok(session)
}

fn send(
    shared: &Shared,
    pending: &Pending,
    token: [u64; 2],
    layout: PayloadLayout,
    answer: &Answer,
) -> Result<(), String> {
    let length = answer.payload.len();
    // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
    if length > REPLY_BYTES && memory::free().is_ok_and(|free| free < reply_sample_bytes(2 * length, layout)) {
        return Err("/dev/shm is full".to_owned());
    }
    let says = |error: &dyn std::fmt::Debug| format!("iceoryx2 reports {error:?}");
    let mut reply = pending.loan_slice_uninit(length).map_err(|error| says(&error))?;
    let header = ReplyHeader { token, ..answer.header };
    let from_daemon = header.instance != 0;
    *reply.user_header_mut() = ReplyHeader {
        protocol_version: if from_daemon { header.protocol_version } else { PROTOCOL_VERSION },
        instance: shared.instance,
        ..header
    };
    reply.write_from_slice(&answer.payload).send().map_err(|error| says(&error))?;
    // An error means that the client is gone.
    let _ = shared.reply_notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY));
    Ok(())
}
