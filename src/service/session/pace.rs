//! How long a session's frames have a processor, by which it is decided who does them.

use std::sync::atomic::{AtomicU64, Ordering};

use rustix::time::{ClockId, clock_gettime};

/// Meshes with more faces than this are large from their first frame on.
const LARGE_FACES: usize = 20_000;
/// A session whose last frame took longer than this is large as well, in nanoseconds.
const LARGE_NS: u64 = 20_000_000;
/// A session whose last frames took no longer than this is brief, in nanoseconds.
const BRIEF_NS: u64 = 300_000;

/// The time for which the calling thread has had a processor, in nanoseconds. A frame that had to wait for a processor
/// itself is not large, or on a busy machine all sessions would be, and wait for those that are. Of a frame that is
/// spread over several threads it is the part of the one that began it.
pub(super) fn processor_ns() -> u64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    let [seconds, nanoseconds] = [time.tv_sec, time.tv_nsec].map(|part| u64::try_from(part).unwrap_or(0));
    seconds * 1_000_000_000 + nanoseconds
}

/// How long the frames of a session take. Written by the worker that has the session, read by all.
#[derive(Debug)]
pub(super) struct Pace {
    num_faces: usize,
    last_ns: AtomicU64,
    /// The longest of the last frames; fades by an eighth with each, so that sessions that are brief now and then are
    /// not taken for brief ones.
    longest_ns: AtomicU64,
}

impl Pace {
    pub(super) fn new(num_faces: usize) -> Self {
        Self { num_faces, last_ns: AtomicU64::new(0), longest_ns: AtomicU64::new(0) }
    }

    /// A frame took so long.
    pub(super) fn record(&self, ns: u64) {
        self.last_ns.store(ns, Ordering::Relaxed);
        let longest_ns = self.longest_ns.load(Ordering::Relaxed);
        self.longest_ns.store(ns.max(longest_ns - longest_ns / 8), Ordering::Relaxed);
    }

    /// Whether a frame may take so long that small sessions must not wait for it.
    pub(super) fn is_large(&self) -> bool {
        self.num_faces > LARGE_FACES || self.last_ns.load(Ordering::Relaxed) > LARGE_NS
    }

    /// Whether a frame takes about as long as waking another thread for it. The first one in which a large mesh
    /// intersects may take far longer, and no other session may have to wait for it.
    pub(super) fn is_brief(&self, has_others: bool) -> bool {
        let longest_ns = self.longest_ns.load(Ordering::Relaxed);
        let may_surprise = has_others && self.num_faces > LARGE_FACES;
        !may_surprise && (1..=BRIEF_NS).contains(&longest_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thread_that_waits_has_no_time_of_a_processor() {
        let begin_ns = processor_ns();
        std::thread::sleep(std::time::Duration::from_nanos(2 * LARGE_NS));
        assert!(processor_ns() - begin_ns < LARGE_NS / 2);
        while processor_ns() - begin_ns < LARGE_NS {
            std::hint::spin_loop();
        }
    }

    #[test]
    fn session_is_brief_when_its_last_frames_were_and_large_when_its_mesh_or_last_frame_is() {
        let pace = Pace::new(100);
        assert!(!pace.is_brief(true) && !pace.is_large(), "nothing is known of it yet");
        pace.record(100_000);
        assert!(pace.is_brief(true));
        pace.record(LARGE_NS + 1);
        assert!(!pace.is_brief(true) && pace.is_large());
        pace.record(100_000);
        assert!(!pace.is_brief(true) && !pace.is_large(), "the next may be long again");
        for _ in 0..40 {
            pace.record(100_000);
        }
        assert!(pace.is_brief(true));
        let large = Pace::new(LARGE_FACES + 1);
        large.record(100_000);
        assert!(large.is_large() && !large.is_brief(true) && large.is_brief(false));
    }
}
