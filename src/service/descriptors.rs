//! The limit of open files. The usual soft limit of 1,024 is less than 64 sessions and their observers take, and a
//! daemon that runs out of descriptors while it cleans up a dead node leaves files in shared memory that nothing
//! removes.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use untangled_proto::limits::MAX_OBSERVERS;

/// Descriptors that a session takes: 17 by count, with repairs 25; rounded up (`tests/daemon/operating/files.rs`
/// counts these, and those of observers).
const PER_SESSION: u64 = 26;
/// Descriptors that a session takes besides once somebody has asked to watch it.
const PER_WATCHED: u64 = 8;
/// Descriptors that an observer takes.
const PER_OBSERVER: u64 = 3;
/// Descriptors of a session that is watched by as many as may. So many are kept for observers in any case.
const MOST_WATCHED: u64 = PER_WATCHED + PER_OBSERVER * MAX_OBSERVERS as u64;
/// Descriptors that the daemon takes itself, for its services and for requests on their way.
const OWN: u64 = 128;

/// What the limit of open files leaves room for. Sessions have their room whoever watches; observers share the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DescriptorRoom {
    /// Most sessions at a time.
    pub(crate) max_sessions: usize,
    /// The limit itself; none where there is no limit.
    pub(crate) limit: Option<u64>,
    /// Descriptors for those who watch.
    pub(crate) for_observers: u64,
}

impl DescriptorRoom {
    fn within(limit: Option<u64>, inherited: u64, max_sessions: usize) -> Self {
        let Some(open) = limit else { return Self { max_sessions, limit, for_observers: u64::MAX } };
        let room = open.saturating_sub(OWN + inherited);
        let fitting = usize::try_from(room.saturating_sub(MOST_WATCHED) / PER_SESSION).unwrap_or(usize::MAX);
        let max_sessions = fitting.min(max_sessions).max(1);
        let for_observers = room.saturating_sub(max_sessions as u64 * PER_SESSION);
        Self { max_sessions, limit, for_observers }
    }
}

/// Descriptors of the views of a session that so many watch.
pub(crate) fn of_views(num_observers: usize) -> u64 {
    PER_WATCHED + PER_OBSERVER * num_observers as u64
}

/// Raises this process's limit of open files to what `max_sessions` and all of their observers need, as far as the
/// system allows. Returns what the limit leaves room for: at most `max_sessions`, at least 1.
pub(crate) fn make_room_for_descriptors(max_sessions: usize) -> DescriptorRoom {
    let limit = getrlimit(Resource::Nofile);
    let inherited = inherited();
    let needed = needed(max_sessions).saturating_add(inherited);
    if limit.current.is_some_and(|current| current < needed) {
        let most = limit.maximum.map_or(needed, |maximum| maximum.min(needed));
        let raised = Rlimit { current: Some(most), maximum: limit.maximum };
        if let Err(error) = setrlimit(Resource::Nofile, raised) {
            tracing::debug!(%error, most, "raising the limit of open files");
        }
    }
    let room = DescriptorRoom::within(getrlimit(Resource::Nofile).current, inherited, max_sessions);
    if room.max_sessions < max_sessions {
        let (limit, room) = (room.limit.unwrap_or(u64::MAX), room.max_sessions);
        tracing::warn!(
            limit,
            needed,
            inherited,
            max_sessions,
            room,
            "the limit of open files leaves room for fewer sessions"
        );
    }
    room
}

/// Descriptors that are open already, but for the first three. A process that has sessions hands over to a daemon that
/// it starts what iceoryx2 0.10 has open for them, and nobody would close it there.
fn inherited() -> u64 {
    // One of them reads the folder.
    std::fs::read_dir("/proc/self/fd").map_or(0, |open| (open.count() as u64).saturating_sub(4))
}

fn needed(num_sessions: usize) -> u64 {
    (num_sessions as u64).saturating_mul(PER_SESSION + MOST_WATCHED).saturating_add(OWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sessions_and_observers_fit_into_what_is_needed() {
        for max_sessions in [1, 2, 32, 64] {
            let room = DescriptorRoom::within(Some(needed(max_sessions)), 0, max_sessions);
            assert_eq!((room.max_sessions, room.for_observers), (max_sessions, max_sessions as u64 * MOST_WATCHED));
        }
    }

    #[test]
    fn few_descriptors_leave_room_for_sessions_and_the_observers_of_one() {
        for (limit, sessions, for_observers) in [
            (0, 1, 0),
            (256, 2, 76),
            (1024, 32, 64),
            (4096, 64, 2304),
            (u64::MAX, 64, u64::MAX - OWN - 64 * PER_SESSION),
        ] {
            let room = DescriptorRoom::within(Some(limit), 0, 64);
            assert_eq!((room.max_sessions, room.for_observers), (sessions, for_observers), "{limit}");
            assert!(limit < 256 || for_observers >= of_views(MAX_OBSERVERS), "{limit}");
        }
        assert_eq!(DescriptorRoom::within(None, 0, 64).for_observers, u64::MAX);
    }

    #[test]
    fn descriptors_of_the_process_that_started_the_daemon_are_no_room_for_sessions() {
        let before = inherited();
        let files: Vec<_> = (0..100).map(|_| std::fs::File::open("/dev/null").unwrap()).collect();
        // Other tests of this process open and close some meanwhile.
        let counted = inherited().saturating_sub(before);
        assert!((60..140).contains(&counted), "{counted}");
        drop(files);
        for (inherited, sessions) in [(0, 32), (8, 32), (9, 31), (840, 1), (2000, 1)] {
            let room = DescriptorRoom::within(Some(1024), inherited, 64);
            assert_eq!(room.max_sessions, sessions, "{inherited}");
            assert!(sessions == 1 || room.for_observers >= of_views(MAX_OBSERVERS), "{inherited}");
        }
    }
}
