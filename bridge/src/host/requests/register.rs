//! A registration: a daemon is chosen, and the ports of the session are made here.

use std::sync::{Arc, atomic::Ordering};

use untangled_proto::{PayloadLayout, RequestHeader, Status, limits, sections::Sections};
use untangled_transport::throttle::Throttle;

use super::{
    ask::{Failure, ask_any},
    reply::Answer,
};
use crate::{
    host::{
        ports::{DownPorts, Shape, StatePort},
        refusal::Refusal,
        session::{Remote, Session},
        shared::Shared,
    },
    net::Outlet,
    wire::{
        keys,
        request::{Reply, Request, Services},
    },
};

/// Registers a session at the least loaded daemon.
pub(super) fn register(
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
