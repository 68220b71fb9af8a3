//! Names of services. `instance` tells one run of a daemon from the next; `session` counts up within a run.

/// Request-response service for requests; the samples of sessions that are registered here are packed.
pub const REQUESTS: &str = "untangled/requests";
/// Event service that wakes the daemon: for a request and for a state. The request-response service of this name is
/// [`REQUESTS`] for clients of release 0.1, with padded samples.
pub const CONTROL: &str = "untangled/control";
/// Event service that tells clients that a reply was sent.
pub const REPLY: &str = "untangled/reply";

/// Event: a request was sent.
pub const EVENT_REQUEST: usize = 1;
/// Event: a state was sent.
pub const EVENT_STATE: usize = 2;
/// Event: a reply was sent.
pub const EVENT_REPLY: usize = 3;
/// Event: a correction was sent.
pub const EVENT_CORRECTION: usize = 4;
/// Event: a notifier of the other side went away.
pub const EVENT_GONE: usize = 5;
/// Event: a repair was sent.
pub const EVENT_REPAIR: usize = 6;
/// Event: a view was sent.
pub const EVENT_VIEW: usize = 7;
/// The largest event id.
pub const EVENT_MAX: usize = 7;

/// One of the services of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionService {
    /// Positions, host to daemon.
    State,
    /// Corrections of all vertices, daemon to host.
    Correction,
    /// Corrections of the vertices that have one, daemon to host; in place of the above where it was asked for.
    Sparse,
    /// Event service that wakes the host.
    Event,
    /// Intersection paths, daemon to each subscriber.
    Paths,
    /// Repairs, daemon to host; only for sessions that asked for them.
    Repair,
    /// Views, daemon to each observer, and the event service that wakes them; from the first request to observe on.
    View,
}

/// The name of a session's service.
#[must_use]
pub fn session(instance: u64, session: u64, service: SessionService) -> String {
    let last = match service {
        SessionService::State => "state",
        SessionService::Correction => "correction",
        SessionService::Sparse => "sparse",
        SessionService::Event => "event",
        SessionService::Paths => "paths",
        SessionService::Repair => "repair",
        SessionService::View => "view",
    };
    format!("untangled/{instance:016x}/{session}/{last}")
}
