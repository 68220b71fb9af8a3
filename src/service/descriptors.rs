//! The limit of open files. The usual soft limit of 1,024 is less than 64 sessions take, and a daemon that runs out of
//! descriptors while it cleans up a dead node leaves files in shared memory that nothing removes.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Descriptors that a session takes: 17 by count, with repairs 25; 8 more while it is watched, and 3 for each of at
/// most 16 observers; rounded up (`tests/daemon/operating/memory.rs` counts them).
const PER_SESSION: u64 = 84;
/// Descriptors that the daemon takes itself, for its services and for requests on their way.
const OWN: u64 = 128;

/// Raises this process's limit of open files to what `max_sessions` need, as far as the system allows. Returns the
/// number of sessions that the limit allows: at most `max_sessions`, at least 1.
pub(crate) fn make_room_for_descriptors(max_sessions: usize) -> usize {
    let limit = getrlimit(Resource::Nofile);
    let needed = needed(max_sessions);
    if limit.current.is_some_and(|current| current < needed) {
        let most = limit.maximum.map_or(needed, |maximum| maximum.min(needed));
        let raised = Rlimit { current: Some(most), maximum: limit.maximum };
        if let Err(error) = setrlimit(Resource::Nofile, raised) {
            tracing::debug!(%error, most, "raising the limit of open files");
        }
    }
    let limit = getrlimit(Resource::Nofile).current;
    let room = limit.map_or(max_sessions, |limit| sessions_within(limit).min(max_sessions));
    if room < max_sessions {
        let limit = limit.unwrap_or(u64::MAX);
        tracing::warn!(limit, needed, max_sessions, room, "the limit of open files leaves room for fewer sessions");
    }
    room
}

fn needed(num_sessions: usize) -> u64 {
    (num_sessions as u64).saturating_mul(PER_SESSION).saturating_add(OWN)
}

fn sessions_within(limit: u64) -> usize {
    usize::try_from(limit.saturating_sub(OWN) / PER_SESSION).unwrap_or(usize::MAX).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sessions_within_inverts_needed() {
        for num_sessions in [1, 2, 32, 64] {
            assert_eq!(sessions_within(needed(num_sessions)), num_sessions);
            assert_eq!(sessions_within(needed(num_sessions) - 1), (num_sessions - 1).max(1));
        }
        assert_eq!((sessions_within(0), sessions_within(1024)), (1, 10));
    }
}
