//! What a daemon serves, and within which limits.

use std::net::SocketAddr;

use untangle::settings::Settings;
use untangled_proto::limits;
use untangled_transport::Domain;

/// Repairs at a time, unless chosen: one may take minutes, and another session does not wait for it.
pub const DEFAULT_REPAIR_WORKERS: usize = 2;

/// What a daemon serves, and within which limits.
#[derive(Clone, Debug)]
pub struct ServeOptions {
    /// Where clients find it.
    pub domain: Domain,
    /// Most sessions at a time, at most [`limits::MAX_SESSIONS`].
    pub max_sessions: usize,
    /// Most sessions of one client, which is one process, at a time.
    pub max_sessions_per_client: usize,
    /// Most vertices of a session.
    pub max_vertices: usize,
    /// Most faces of a session.
    pub max_faces: usize,
    /// Most memory of a session in bytes, as [estimated](super::session::memory_bytes) at its registration.
    pub max_session_memory_bytes: u64,
    /// Threads that work on frames, at least 2; 0 for as many as there are processors.
    pub num_workers: usize,
    /// Repairs at a time, at least 1.
    pub num_repair_workers: usize,
    /// Where to serve metrics as Prometheus text over HTTP, if at all. Every user who can connect can read them:
    /// loopback addresses only.
    pub metrics: Option<SocketAddr>,
    /// Settings of sessions, where a session does not choose its own.
    pub settings: Settings,
}

impl ServeOptions {
    /// A domain with default limits and settings.
    #[must_use]
    pub fn new(domain: Domain) -> Self {
        Self {
            domain,
            max_sessions: limits::MAX_SESSIONS,
            max_sessions_per_client: limits::MAX_SESSIONS,
            max_vertices: limits::MAX_VERTICES,
            max_faces: limits::MAX_FACES,
            max_session_memory_bytes: u64::MAX,
            num_workers: 0,
            num_repair_workers: DEFAULT_REPAIR_WORKERS,
            metrics: None,
            settings: Settings::default(),
        }
    }

    /// Number of workers to start: as chosen, or one for each processor, but at least 2.
    pub(crate) fn num_workers(&self) -> usize {
        let chosen = match self.num_workers {
            0 => std::thread::available_parallelism().map_or(2, usize::from),
            chosen => chosen,
        };
        chosen.max(2)
    }
}
