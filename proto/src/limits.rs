//! What a peer may ask for; what it costs in shared memory is in [`memory`](crate::memory).

/// Most sessions of one daemon.
pub const MAX_SESSIONS: usize = 64;
/// Most connected clients of one daemon; one client may hold several sessions.
pub const MAX_CLIENTS: usize = 64;
/// Most vertices of a session, unless the daemon's configuration says less.
pub const MAX_VERTICES: usize = 1 << 24;
/// Most faces of a session, unless the daemon's configuration says less.
pub const MAX_FACES: usize = 1 << 25;
/// Most sections of a request.
pub const MAX_SECTIONS: usize = 32;
/// Longest settings document in bytes.
pub const MAX_SETTINGS_BYTES: usize = 1 << 20;

/// Shortest step of a frame in seconds.
pub const MIN_DT_S: f64 = 1e-9;
/// Longest step of a frame in seconds.
pub const MAX_DT_S: f64 = 1e9;

/// Frames that wait for the daemon: the newest only.
pub const STATE_BUFFER: usize = 1;
/// States that the daemon holds at a time.
pub const STATE_BORROWED: usize = 1;
/// Corrections that wait for the host.
pub const CORRECTION_BUFFER: usize = 2;
/// Corrections that a host may hold at a time.
pub const CORRECTION_BORROWED: usize = 4;
/// Listeners to a session's paths.
pub const PATHS_SUBSCRIBERS: usize = 4;
/// Paths that a listener may hold at a time: those of all corrections that a host may hold.
pub const PATHS_BORROWED: usize = CORRECTION_BORROWED;
/// Repairs that wait for the host: the newest only.
pub const REPAIR_BUFFER: usize = 1;
/// Repairs that a host may hold at a time.
pub const REPAIR_BORROWED: usize = 2;
/// Observers of a session.
pub const MAX_OBSERVERS: usize = 16;
/// Views that wait for an observer: the newest only.
pub const VIEW_BUFFER: usize = 1;
/// Views that an observer may hold at a time.
pub const VIEW_BORROWED: usize = 1;
/// Longest name of an observer in bytes.
pub const MAX_NAME_BYTES: usize = 64;
/// Longest part of a mesh in a reply to an observer in bytes: replies of this length keep the daemon's port small.
pub const MAX_PART_BYTES: usize = 1 << 16;
