//! Requests of hosts: each is passed on to the daemon, and a registration opens a link.

use std::{
    sync::{Arc, atomic::Ordering},
    time::Duration,
};

use untangled_client::RequestError;
use untangled_proto::{PROTOCOL_VERSION, RequestKind, Status};
use zenoh::{Wait, query::Query};

use super::{
    link::{Answers, Link},
    local::Local,
    ports::Shape,
    shared::Shared,
};
use crate::{
    metrics::count,
    net::Outlet,
    throttle::Throttle,
    wire::{
        keys,
        request::{Reply, Request, Services},
    },
};

/// Longest time that the daemon may take for a registration, and for another request.
const REGISTRATION: Duration = Duration::from_secs(50);
const OTHER: Duration = Duration::from_secs(4);

/// Takes a query, and answers it in a thread of its own. Never waits.
pub(super) fn take(shared: &Arc<Shared>, query: Query) {
    count(&shared.metrics.num_requests);
    let key = query.key_expr().to_string();
    let Some(key) = keys::parse(&key).filter(|key| shared.is_allowed(key.host)) else {
        return refuse(shared, &query, "this host is not among those that may use the daemon".to_owned());
    };
    let length = query.payload().map_or(0, zenoh::bytes::ZBytes::len);
    if length > shared.max_request_bytes {
        let words = format!("a request of {length} bytes; at most {} are allowed", shared.max_request_bytes);
        return refuse(shared, &query, words);
    }
    let host = match shared.hosts.begin_request(key.host) {
        Ok(host) => host,
        Err(words) => return refuse(shared, &query, words),
    };
    let (name, worker) = (Arc::clone(&host), Arc::clone(shared));
    let work = move || {
        answer(&worker, &name, &query);
        drop(query);
        worker.hosts.end_request(&name);
    };
    if let Err(error) = std::thread::Builder::new().name("request".into()).spawn(work) {
        tracing::warn!(%error, "starting a thread for a request");
        shared.hosts.end_request(&host);
    }
}

fn refuse(shared: &Shared, query: &Query, words: String) {
    static REFUSED: Throttle = Throttle::new();
    count(&shared.metrics.num_refused_requests);
    if let Some(num_suppressed) = REFUSED.admit() {
        tracing::warn!(key = %query.key_expr(), reason = words, num_suppressed, "a request was refused");
    }
    reply(query, &Reply::Refused(words));
}

fn reply(query: &Query, reply: &Reply) {
    let sent = query.reply(query.key_expr().clone(), reply.to_bytes()).wait();
    if let Err(error) = sent {
        tracing::debug!(%error, "replying");
    }
}

fn answer(shared: &Arc<Shared>, host: &Arc<str>, query: &Query) {
    let bytes = query.payload().map(zenoh::bytes::ZBytes::to_bytes).unwrap_or_default();
    let answer = match Request::read(&bytes) {
        Some(request) => serve(shared, host, &request),
        None => Reply::Refused("the request is malformed, or of another version of the bridge".to_owned()),
    };
    if let Reply::Refused(words) = answer {
        return refuse(shared, query, words);
    }
    reply(query, &answer);
}

fn serve(shared: &Arc<Shared>, host: &Arc<str>, request: &Request<'_>) -> Reply {
    let Some(local) = shared.local() else { return Reply::NoDaemon(shared.no_daemon()) };
    let header = &request.header;
    let is_current = header.protocol_version == PROTOCOL_VERSION;
    match RequestKind::from_code(header.kind) {
        Some(RequestKind::Register) if is_current => register(shared, &local, host, request),
        Some(RequestKind::UpdateSettings | RequestKind::Close) if is_current => {
            // A host may change its own sessions only.
            let Some(link) = shared.hosts.link(host, request.link).filter(|link| link.session() == header.session)
            else {
                return Reply::Refused(format!("there is no session {}", header.session));
            };
            let reply = forward(shared, &local, request, OTHER);
            if header.kind == RequestKind::Close as u32 {
                link.end();
                shared.hosts.finish_link(host, request.link, None);
            }
            reply
        }
        // It would show one host the cloth of another.
        Some(RequestKind::Observe) => Reply::Refused("a session can't be watched through a bridge".to_owned()),
        _ => forward(shared, &local, request, OTHER),
    }
}

fn forward(shared: &Shared, local: &Local, request: &Request<'_>, time: Duration) -> Reply {
    match local.forward(&request.header, request.payload, time) {
        Ok(raw) => Reply::Answered { services: Services::default(), header: raw.header, payload: raw.payload },
        Err(error) => no_answer(shared, &error),
    }
}

/// What a host is told where the daemon did not answer.
fn no_answer(shared: &Shared, error: &RequestError) -> Reply {
    match error {
        RequestError::NotEnoughMemory { .. } => Reply::Refused(format!("on the daemon's machine: {error}")),
        _ => {
            tracing::info!(%error, "asking the daemon");
            Reply::NoDaemon(shared.no_daemon())
        }
    }
}

fn register(shared: &Arc<Shared>, local: &Arc<Local>, host: &Arc<str>, request: &Request<'_>) -> Reply {
    if let Err(words) = shared.hosts.begin_link(host, request.link) {
        return Reply::Refused(words);
    }
    let (reply, link) = open(shared, local, host, request);
    shared.hosts.finish_link(host, request.link, link);
    reply
}

fn open(
    shared: &Arc<Shared>,
    local: &Arc<Local>,
    host: &Arc<str>,
    request: &Request<'_>,
) -> (Reply, Option<Arc<Link>>) {
    let raw = match local.forward(&request.header, request.payload, REGISTRATION) {
        Ok(raw) => raw,
        Err(error) => return (no_answer(shared, &error), None),
    };
    let mut services = Services::default();
    if raw.header.status != Status::Ok.code() {
        return (Reply::Answered { services, header: raw.header, payload: raw.payload }, None);
    }
    let runs = [raw.header.instance, raw.header.session];
    let Some(shape) = Shape::read(request.payload, request.header.num_sections, runs) else {
        return (Reply::Refused("the daemon took a registration that this bridge can't read".to_owned()), None);
    };
    let key = keys::down(&shared.name, host, &keys::link(request.link));
    let opened = Outlet::new(&shared.network, &key, request.link, Arc::clone(&shared.metrics))
        .map_err(|error| error.to_string())
        .and_then(|outlet| {
            let answers = Answers::open(local, &shape).map_err(|error| error.to_string())?;
            services = answers.services();
            let link = Link::open(Arc::clone(host), shape, outlet, Arc::clone(&shared.metrics), Arc::clone(local))
                .map_err(|error| error.to_string())?;
            let link = Arc::new(link);
            link.start(answers).map_err(|error| error.to_string())?;
            Ok(link)
        });
    match opened {
        Ok(link) => {
            shared.has_new_link.store(true, Ordering::Relaxed);
            static OPENED: Throttle = Throttle::new();
            if let Some(num_suppressed) = OPENED.admit() {
                let num_vertices = shape.num_vertices;
                tracing::info!(host = &**host, session = shape.session, num_vertices, num_suppressed, "session opened");
            }
            (Reply::Answered { services, header: raw.header, payload: raw.payload }, Some(link))
        }
        // The session ends by itself: nobody takes it up.
        Err(words) => (Reply::Refused(format!("on the daemon's machine: {words}")), None),
    }
}
