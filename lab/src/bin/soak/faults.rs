//! Faults, each tried as often as asked for: what dies, and what the living lose by it.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rand::{RngExt, SeedableRng, rngs::StdRng};
use rustix::process::Signal;
use untangled_client::{ExchangeError, PublishError, WaitError};

use super::{
    processes::{ClientProcess, Daemon, Programs, TestDomain, eventually},
    scene::Scene,
};

/// A row of the fault table.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub what: String,
    pub num_tries: u64,
    /// Frames that living clients exchanged meanwhile, each compared with the library's answer bit by bit.
    pub num_frames: u64,
    /// Frames with a wrong answer.
    pub num_wrong: u64,
    /// Frames of living clients without an answer that was due: not counted while their daemon is dead.
    pub num_lost: u64,
    pub note: String,
}

impl Row {
    pub fn is_clean(&self) -> bool {
        self.num_wrong == 0 && self.num_lost == 0
    }
}

/// A living client: it exchanges frames on a thread of its own and compares every answer.
pub struct Witness {
    counts: Arc<Counts>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Counts {
    ending: AtomicBool,
    num_frames: AtomicU64,
    num_wrong: AtomicU64,
    num_lost: AtomicU64,
    /// Frames without an answer while a daemon was dead or coming up.
    num_orphaned: AtomicU64,
}

impl Witness {
    /// Begins to exchange frames; `pause` after each. With `restarts` the daemon may go away and come back.
    pub fn start(domain: &TestDomain, num_vertices: usize, pause: Duration, restarts: bool) -> Self {
        let counts = Arc::new(Counts::default());
        let scene = Scene::new(num_vertices);
        let mut session = domain.connect().register(scene.registration()).expect("a daemon that serves");
        let shared = Arc::clone(&counts);
        let thread = std::thread::spawn(move || {
            let counts = shared;
            let patience = if restarts { Duration::from_millis(300) } else { Duration::from_secs(30) };
            while !counts.ending.load(Ordering::Relaxed) {
                let count = match scene.exchange(&mut session, patience) {
                    Ok(correction) if scene.is_right(&correction) && correction.frame() == session.frame() => {
                        &counts.num_frames
                    }
                    Ok(_) => &counts.num_wrong,
                    Err(
                        ExchangeError::Publish(PublishError::Reconnecting)
                        | ExchangeError::Wait(WaitError::DaemonLost { .. } | WaitError::Timeout { .. }),
                    ) if restarts => &counts.num_orphaned,
                    Err(error) => {
                        eprintln!("a witness of {num_vertices} vertices: {error}");
                        &counts.num_lost
                    }
                };
                count.fetch_add(1, Ordering::Relaxed);
                std::thread::sleep(pause);
            }
        });
        Self { counts, thread: Some(thread) }
    }

    pub fn num_frames(&self) -> u64 {
        self.counts.num_frames.load(Ordering::Relaxed)
    }

    /// Waits until it has exchanged another frame.
    pub fn wait_for_frame(&self) {
        let before = self.num_frames();
        eventually("another frame", || self.num_frames() > before);
    }

    /// Ends it and adds up what it saw; returns the frames without an answer while the daemon was away.
    pub fn finish(mut self, row: &mut Row) -> u64 {
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

fn status_of(domain: &TestDomain) -> serde_json::Value {
    domain.connect().status().expect("the daemon answers")
}

fn num_sessions(domain: &TestDomain) -> usize {
    status_of(domain)["sessions"].as_array().map_or(0, Vec::len)
}

/// Ends a daemon and says what it left.
fn end_cleanly(daemon: Daemon, domain: &TestDomain) {
    assert!(daemon.stop(Signal::TERM).success(), "the daemon ends well");
    assert_eq!((domain.shared_memory().0, domain.num_files()), (0, 0), "nothing is left");
}

/// Clients killed at any moment: while they connect, register, exchange frames, or hold a loan.
pub fn client_kills(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "client killed at any moment".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(programs, &domain, &[]);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    witness.wait_for_frame();
    let before = (domain.shared_memory().0, daemon.memory(), domain.num_files());
    let mut moments = std::collections::BTreeMap::<String, u64>::new();
    for attempt in 0..num_tries {
        let role = ["frames", "register", "loan"][attempt as usize % 3];
        let mut client = ClientProcess::start(programs, &domain, role);
        match rng.random_range(0..4) {
            0 => {}
            1 => client.wait_for("at connected"),
            2 => client.wait_for("at registering"),
            _ => client.wait_for(if role == "register" { "at registered" } else { "at frame" }),
        }
        std::thread::sleep(Duration::from_micros(rng.random_range(0..20_000)));
        *moments.entry(client.kill()).or_default() += 1;
    }
    eventually("the sessions of the dead are gone", || num_sessions(&domain) == 1);
    eventually("their shared memory is gone", || domain.shared_memory().0 <= before.0);
    eventually("their files are gone", || domain.num_files() <= before.2);
    row.note = format!(
        "killed {}; shared-memory files {} before and {} after, daemon's memory {:.1} and {:.1} MB",
        moments.iter().map(|(moment, count)| format!("{moment} {count}")).collect::<Vec<_>>().join(", "),
        before.0,
        domain.shared_memory().0,
        before.1 as f64 / 1e6,
        daemon.memory() as f64 / 1e6,
    );
    assert!(daemon.is_running());
    witness.finish(&mut row);
    end_cleanly(daemon, &domain);
    row
}

/// Daemons killed at any moment under two clients, which go on with the next one.
pub fn daemon_kills(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "daemon killed at any moment and restarted".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(programs, &domain, &[]);
    let witnesses = [500, 5000].map(|size| Witness::start(&domain, size, Duration::from_millis(1), true));
    for _ in 0..num_tries {
        if rng.random_bool(0.5) {
            // Otherwise it may be killed before anybody has come back to it.
            witnesses.iter().for_each(Witness::wait_for_frame);
        }
        std::thread::sleep(Duration::from_micros(rng.random_range(0..100_000)));
        daemon.stop(Signal::KILL);
        daemon = Daemon::start(programs, &domain, &[]);
    }
    witnesses.iter().for_each(Witness::wait_for_frame);
    let orphaned: u64 = witnesses.into_iter().map(|witness| witness.finish(&mut row)).sum();
    row.note = format!("2 clients went on each time; {orphaned} frames without an answer while there was no daemon");
    eventually("the clients are gone", || num_sessions(&domain) == 0);
    end_cleanly(daemon, &domain);
    row
}

/// Everybody killed at once; the next daemon and client start afresh.
pub fn all_killed(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "daemon and all clients killed together".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    for _ in 0..num_tries {
        let daemon = Daemon::start(programs, &domain, &[]);
        let clients = ["frames", "register"].map(|role| ClientProcess::start(programs, &domain, role));
        let witness = Witness::start(&domain, 100, Duration::ZERO, false);
        witness.wait_for_frame();
        witness.finish(&mut row);
        std::thread::sleep(Duration::from_micros(rng.random_range(0..30_000)));
        daemon.stop(Signal::KILL);
        for client in clients {
            client.kill();
        }
    }
    end_cleanly(Daemon::start(programs, &domain, &[]), &domain);
    row.note = "each next daemon served; the last one left nothing".into();
    row
}

/// A client stopped for a while in the middle of its frames, while another works.
pub fn stopped_clients(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "client stopped (SIGSTOP) while others work".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = Daemon::start(programs, &domain, &[]);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    let mut client = ClientProcess::start(programs, &domain, "frames");
    for _ in 0..num_tries {
        client.wait_for("at frame");
        std::thread::sleep(Duration::from_micros(rng.random_range(0..5_000)));
        client.signal(Signal::STOP);
        for _ in 0..20 {
            witness.wait_for_frame();
        }
        client.signal(Signal::CONT);
    }
    client.wait_for("at frame");
    row.note = "the stopped client went on each time".into();
    client.kill();
    witness.finish(&mut row);
    end_cleanly(daemon, &domain);
    row
}

/// Many sessions at once, from 8 to 100,000 vertices, for a while.
pub fn many_sessions(programs: Programs, num_sessions: usize, time: Duration) -> Row {
    let mut row = Row { num_tries: num_sessions as u64, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = Daemon::start(programs, &domain, &[]);
    let size = |k: usize| 10.0 * 10_000f64.powf(k as f64 / (num_sessions - 1) as f64);
    let witnesses: Vec<Witness> =
        (0..num_sessions).map(|k| Witness::start(&domain, size(k) as usize, Duration::from_millis(5), false)).collect();
    for witness in &witnesses {
        while witness.num_frames() < 10 {
            witness.wait_for_frame();
        }
    }
    let (begin, before) = (Instant::now(), (domain.shared_memory(), daemon.memory()));
    let mut largest = before;
    while begin.elapsed() < time {
        std::thread::sleep(Duration::from_secs(1).min(time));
        let now = (domain.shared_memory(), daemon.memory());
        largest = (largest.0.max(now.0), largest.1.max(now.1));
    }
    let after = (domain.shared_memory(), daemon.memory());
    let fewest = witnesses.iter().map(Witness::num_frames).min().unwrap_or(0);
    for witness in witnesses {
        witness.finish(&mut row);
    }
    let megabytes = |bytes: u64| bytes as f64 / 1e6;
    row.what = format!("{num_sessions} sessions of 10 to 100,000 vertices for {:.0} s", time.as_secs_f64());
    row.note = format!(
        "shared-memory files {} at the start, {} at the end, {:.1} and {:.1} MB; daemon's own memory {:.1} MB at the start, {:.1} at most, {:.1} at the end; at least {fewest} frames in each session",
        before.0.0,
        after.0.0,
        megabytes(before.0.1),
        megabytes(after.0.1),
        megabytes(before.1),
        megabytes(largest.1),
        megabytes(after.1),
    );
    row.num_lost += u64::from(after.0.0 > before.0.0);
    end_cleanly(daemon, &domain);
    row
}

/// Sessions opened, used and closed, one after the other.
pub fn open_and_close(programs: Programs, num_tries: u64) -> Row {
    let mut row = Row { what: "session opened, used and closed".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = Daemon::start(programs, &domain, &[]);
    let client = domain.connect();
    let scene = Scene::new(500);
    let once = |row: &mut Row| {
        let mut session = client.register(scene.registration()).expect("there is room for one session");
        for _ in 0..3 {
            match scene.exchange(&mut session, Duration::from_secs(30)) {
                Ok(correction) if scene.is_right(&correction) => row.num_frames += 1,
                Ok(_) => row.num_wrong += 1,
                Err(_) => row.num_lost += 1,
            }
        }
    };
    let warm_up = num_tries.div_ceil(10);
    (0..warm_up).for_each(|_| once(&mut row));
    let settle = || eventually("closed sessions are gone", || num_sessions(&domain) == 0);
    settle();
    let before = (domain.shared_memory().0, domain.num_files(), daemon.memory());
    (warm_up..num_tries).for_each(|_| once(&mut row));
    settle();
    // What a session leaves goes with the next round of cleaning up.
    let is_more = || domain.shared_memory().0 > before.0 || domain.num_files() > before.1;
    let patience = Instant::now() + Duration::from_secs(20);
    while is_more() && Instant::now() < patience {
        thread::sleep(Duration::from_millis(100));
    }
    let after = (domain.shared_memory().0, domain.num_files(), daemon.memory());
    row.note = format!(
        "after {warm_up} and after all: shared-memory files {} and {}, other files {} and {}, daemon's memory {:.2} and {:.2} MB",
        before.0,
        after.0,
        before.1,
        after.1,
        before.2 as f64 / 1e6,
        after.2 as f64 / 1e6,
    );
    row.num_lost += u64::from(after.0 > before.0 || after.1 > before.1);
    drop(client);
    end_cleanly(daemon, &domain);
    row
}
