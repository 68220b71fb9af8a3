//! A client that works while others suffer a fault.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::{ExchangeError, PublishError, Session, WaitError};

use super::row::Row;
use crate::process::{Daemon, KnownCloth, Programs, TestDomain, eventually};

/// A living client: it exchanges frames on a thread of its own and compares every answer.
#[derive(Debug)]
pub(super) struct Witness {
    counts: Arc<Counts>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Counts {
    ending: AtomicBool,
    num_frames: AtomicU64,
    num_wrong: AtomicU64,
    num_lost: AtomicU64,
    /// Frames without an answer while a daemon was dead or coming up.
    num_orphaned: AtomicU64,
}

impl Counts {
    /// Exchanges frames until told to end, and counts them by their answers.
    fn exchange_frames(&self, cloth: &KnownCloth, mut session: Session, pause: Duration, restarts: bool) {
        let patience = if restarts { Duration::from_millis(300) } else { Duration::from_secs(30) };
        while !self.ending.load(Ordering::Relaxed) {
            let count = match cloth.exchange(&mut session, patience) {
                Ok(correction) if cloth.is_right(&correction) && correction.frame() == session.frame() => {
                    &self.num_frames
                }
                Ok(_) => &self.num_wrong,
                Err(
                    ExchangeError::Publish(PublishError::Reconnecting)
                    | ExchangeError::Wait(WaitError::DaemonLost { .. } | WaitError::Timeout { .. }),
                ) if restarts => &self.num_orphaned,
                Err(error) => {
                    eprintln!("a witness of {} vertices: {error}", cloth.num_vertices());
                    &self.num_lost
                }
            };
            count.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(pause);
        }
    }
}

impl Witness {
    /// Begins to exchange frames; `pause` after each. With `restarts` the daemon may go away and come back.
    pub(super) fn start(domain: &TestDomain, num_vertices: usize, pause: Duration, restarts: bool) -> Self {
        let counts = Arc::new(Counts::default());
        let cloth = KnownCloth::new(num_vertices);
        let session = domain.connect().register(cloth.registration()).expect("a daemon that serves");
        let shared = Arc::clone(&counts);
        let thread = std::thread::spawn(move || shared.exchange_frames(&cloth, session, pause, restarts));
        Self { counts, thread: Some(thread) }
    }

    /// Frames with the right answer so far.
    pub(super) fn num_frames(&self) -> u64 {
        self.counts.num_frames.load(Ordering::Relaxed)
    }

    /// Waits until it has exchanged another frame.
    pub(super) fn wait_for_frame(&self) {
        let before = self.num_frames();
        eventually("another frame", || self.num_frames() > before);
    }

    /// Ends it and adds up what it saw; returns the frames without an answer while the daemon was away.
    pub(super) fn finish(mut self, row: &mut Row) -> u64 {
        self.counts.ending.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            row.num_lost += 1;
        }
        let count = |count: &AtomicU64| count.load(Ordering::Relaxed);
        row.num_frames += count(&self.counts.num_frames);
        row.num_wrong += count(&self.counts.num_wrong);
        row.num_lost += count(&self.counts.num_lost);
        count(&self.counts.num_orphaned)
    }
}

/// Starts a daemon with a client that works while the trial goes on.
pub(super) fn bystanders(programs: Programs) -> (TestDomain, Daemon, Witness) {
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    witness.wait_for_frame();
    (domain, daemon, witness)
}

/// Asserts that daemon and client have come through, and ends both.
pub(super) fn finish(domain: &TestDomain, mut daemon: Daemon, witness: Witness, row: &mut Row) {
    witness.wait_for_frame();
    witness.finish(row);
    assert!(daemon.is_running(), "the daemon lives");
    assert!(daemon.stop(Signal::TERM).success());
    assert_eq!(domain.shared_memory(), Vec::<String>::new());
}
