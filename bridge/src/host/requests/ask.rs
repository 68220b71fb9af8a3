//! Questions to daemon ends.

use std::time::Duration;

use untangled_proto::{RequestKind, Status};
use zenoh::{Wait, query::ConsolidationMode};

use crate::{
    host::{refusal::Refusal, session::Remote, shared::Shared},
    net::Urgency,
    wire::{
        keys,
        request::{Reply, Request},
    },
};

/// Longest time that a daemon end may take for a registration, and for another request.
pub(super) const REGISTRATION: Duration = Duration::from_secs(60);
const OTHER: Duration = Duration::from_secs(5);

/// Why there is no answer.
pub(super) enum Failure {
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

/// Asks one daemon end.
pub(super) fn ask(shared: &Shared, daemon: &str, request: &Request<'_>) -> Option<Reply> {
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
pub(super) fn ask_any(shared: &Shared, request: &Request<'_>) -> Result<(Remote, Reply), Failure> {
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
