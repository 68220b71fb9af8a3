//! The way of a request: from a host to a daemon elsewhere, and the reply back.

mod ask;
mod register;
mod reply;

use std::{
    sync::{Arc, atomic::Ordering},
    time::{Duration, Instant},
};

use untangled_proto::{PROTOCOL_VERSION, PayloadLayout, ReplyHeader, RequestHeader, RequestKind, Status};

use self::{
    ask::{Failure, REGISTRATION, ask, ask_any},
    register::register,
    reply::{Answer, reply},
};
use super::{front::Pending, refusal::Refusal, shared::Shared, status};
use crate::{
    metrics::count,
    wire::request::{Reply, Request},
};

/// Time until a request that no daemon has answered is asked again.
const RETRY: Duration = Duration::from_millis(20);

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
