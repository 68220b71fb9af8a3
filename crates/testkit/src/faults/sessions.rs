//! Many sessions at once, and many one after the other.

use std::{
    thread,
    time::{Duration, Instant},
};

use untangled_client::Client;

use super::{
    end::{end_cleanly, num_sessions},
    row::Row,
    witness::Witness,
};
use crate::process::{Daemon, KnownCloth, Programs, TestDomain, eventually};

/// What a domain and its daemon take.
struct Usage {
    shared_files: usize,
    shared_bytes: u64,
    files: usize,
    daemon_bytes: u64,
}

impl Usage {
    fn of(domain: &TestDomain, daemon: &Daemon) -> Self {
        Self {
            shared_files: domain.shared_memory().len(),
            shared_bytes: domain.shared_bytes(),
            files: domain.files().len(),
            daemon_bytes: daemon.memory(),
        }
    }
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Many sessions at once, from 8 to 100,000 vertices, for a while.
pub fn many_sessions(programs: Programs, num_sessions: usize, time: Duration) -> Row {
    let mut row = Row { num_tries: num_sessions as u64, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let size = |k: usize| 10.0 * 10_000f64.powf(k as f64 / (num_sessions - 1) as f64);
    let witnesses: Vec<Witness> =
        (0..num_sessions).map(|k| Witness::start(&domain, size(k) as usize, Duration::from_millis(5), false)).collect();
    for witness in &witnesses {
        while witness.num_frames() < 10 {
            witness.wait_for_frame();
        }
    }
    let (begin, before) = (Instant::now(), Usage::of(&domain, &daemon));
    let mut most_bytes = before.daemon_bytes;
    while begin.elapsed() < time {
        thread::sleep(Duration::from_secs(1).min(time));
        most_bytes = most_bytes.max(daemon.memory());
    }
    let after = Usage::of(&domain, &daemon);
    let fewest = witnesses.iter().map(Witness::num_frames).min().unwrap_or(0);
    for witness in witnesses {
        witness.finish(&mut row);
    }
    row.what = format!("{num_sessions} sessions of 10 to 100,000 vertices for {:.0} s", time.as_secs_f64());
    row.note = format!(
        "shared-memory files {} at the start, {} at the end, {:.1} and {:.1} MB; daemon's own memory {:.1} MB at the \
         start, {:.1} at most, {:.1} at the end; at least {fewest} frames in each session",
        before.shared_files,
        after.shared_files,
        megabytes(before.shared_bytes),
        megabytes(after.shared_bytes),
        megabytes(before.daemon_bytes),
        megabytes(most_bytes),
        megabytes(after.daemon_bytes),
    );
    row.num_lost += u64::from(after.shared_files > before.shared_files);
    end_cleanly(daemon, &domain);
    row
}

/// Sessions opened, used and closed, one after the other.
pub fn open_and_close(programs: Programs, num_tries: u64) -> Row {
    let mut row = Row { what: "session opened, used and closed".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let cloth = KnownCloth::new(500);
    let warm_up = num_tries.div_ceil(10);
    (0..warm_up).for_each(|_| open_use_close(&client, &cloth, &mut row));
    let settle = || eventually("closed sessions are gone", || num_sessions(&domain) == 0);
    settle();
    let before = Usage::of(&domain, &daemon);
    (warm_up..num_tries).for_each(|_| open_use_close(&client, &cloth, &mut row));
    settle();
    // The files of a session go with the next round of housekeeping.
    let is_more = |now: &Usage| now.shared_files > before.shared_files || now.files > before.files;
    let patience = Instant::now() + Duration::from_secs(20);
    while is_more(&Usage::of(&domain, &daemon)) && Instant::now() < patience {
        thread::sleep(Duration::from_millis(100));
    }
    let after = Usage::of(&domain, &daemon);
    row.note = format!(
        "after {warm_up} and after all: shared-memory files {} and {}, other files {} and {}, \
         daemon's memory {:.2} and {:.2} MB",
        before.shared_files,
        after.shared_files,
        before.files,
        after.files,
        megabytes(before.daemon_bytes),
        megabytes(after.daemon_bytes),
    );
    row.num_lost += u64::from(is_more(&after));
    drop(client);
    end_cleanly(daemon, &domain);
    row
}

/// Opens a session, exchanges three frames and closes it.
fn open_use_close(client: &Client, cloth: &KnownCloth, row: &mut Row) {
    let mut session = client.register(cloth.registration()).expect("there is room for one session");
    for _ in 0..3 {
        match cloth.exchange(&mut session, Duration::from_secs(30)) {
            Ok(correction) if cloth.is_right(&correction) => row.num_frames += 1,
            Ok(_) => row.num_wrong += 1,
            Err(_) => row.num_lost += 1,
        }
    }
}
