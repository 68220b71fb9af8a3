//! Processes killed or stopped at any moment.

use std::{collections::BTreeMap, thread, time::Duration};

use rand::{RngExt, SeedableRng, rngs::StdRng};
use rustix::process::Signal;

use super::{
    end::{end_cleanly, num_observers, num_sessions},
    row::Row,
    witness::Witness,
};
use crate::process::{ClientProcess, Programs, TestDomain, eventually, eventually_no_more};

/// Clients killed at any moment: while they connect, register, exchange frames, or hold a loan.
pub fn client_kills(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "client killed at any moment".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let mut daemon = programs.start_daemon(&domain);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    witness.wait_for_frame();
    let before = (domain.shared_memory(), daemon.memory(), domain.files());
    let mut moments = BTreeMap::<String, u64>::new();
    for attempt in 0..num_tries {
        let role = ["frames", "register", "loan"][attempt as usize % 3];
        let mut client = ClientProcess::start(programs, &domain, role);
        match rng.random_range(0..4) {
            0 => {}
            1 => client.wait_for("at connected"),
            2 => client.wait_for("at registering"),
            _ => client.wait_for(if role == "register" { "at registered" } else { "at frame" }),
        }
        thread::sleep(Duration::from_micros(rng.random_range(0..20_000)));
        *moments.entry(client.kill()).or_default() += 1;
    }
    eventually("the sessions of the dead are gone", || num_sessions(&domain) == 1);
    eventually_no_more("shared memory than before", &before.0, || domain.shared_memory());
    eventually_no_more("files than before", &before.2, || domain.files());
    row.note = format!(
        "killed {}; shared-memory files {} before and {} after, daemon's memory {:.1} and {:.1} MB",
        moments.iter().map(|(moment, count)| format!("{moment} {count}")).collect::<Vec<_>>().join(", "),
        before.0.len(),
        domain.shared_memory().len(),
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
    let mut daemon = programs.start_daemon(&domain);
    let witnesses = [500, 5000].map(|size| Witness::start(&domain, size, Duration::from_millis(1), true));
    for _ in 0..num_tries {
        if rng.random_bool(0.5) {
            // Otherwise it may be killed before anybody has come back to it.
            witnesses.iter().for_each(Witness::wait_for_frame);
        }
        thread::sleep(Duration::from_micros(rng.random_range(0..100_000)));
        daemon.stop(Signal::KILL);
        daemon = programs.start_daemon(&domain);
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
        let daemon = programs.start_daemon(&domain);
        let clients = ["frames", "register"].map(|role| ClientProcess::start(programs, &domain, role));
        let witness = Witness::start(&domain, 100, Duration::ZERO, false);
        witness.wait_for_frame();
        witness.finish(&mut row);
        thread::sleep(Duration::from_micros(rng.random_range(0..30_000)));
        daemon.stop(Signal::KILL);
        for client in clients {
            client.kill();
        }
    }
    end_cleanly(programs.start_daemon(&domain), &domain);
    row.note = "each next daemon served; the last one left nothing".into();
    row
}

/// A client stopped for a while in the middle of its frames, while another works.
pub fn stopped_clients(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "client stopped (SIGSTOP) while others work".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    let mut client = ClientProcess::start(programs, &domain, "frames");
    for _ in 0..num_tries {
        client.wait_for("at frame");
        thread::sleep(Duration::from_micros(rng.random_range(0..5_000)));
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

/// Observers of a working client's session, killed at any moment and stopped for a while.
pub fn observer_faults(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "observer killed at any moment, or stopped".into(), num_tries, ..Row::default() };
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let witness = Witness::start(&domain, 500, Duration::from_millis(1), false);
    witness.wait_for_frame();
    let start = || ClientProcess::start(programs, &domain, "observe");
    let mut stopped = start();
    for _ in 0..num_tries {
        stopped.wait_for("at seen");
        stopped.signal(Signal::STOP);
        let mut observer = start();
        match rng.random_range(0..3) {
            0 => {}
            1 => observer.wait_for("at opening"),
            _ => observer.wait_for("at seen"),
        }
        thread::sleep(Duration::from_micros(rng.random_range(0..20_000)));
        row.num_wrong += u64::from(observer.kill().contains("wrong"));
        // More views than the stopped one has room for.
        (0..100).for_each(|_| witness.wait_for_frame());
        stopped.signal(Signal::CONT);
    }
    stopped.wait_for("at seen");
    row.note = "killed while it connected, opened or watched; the stopped one went on each time".into();
    row.num_wrong += u64::from(stopped.kill().contains("wrong"));
    eventually("the dead observers are gone", || num_observers(&domain) == 0);
    witness.finish(&mut row);
    end_cleanly(daemon, &domain);
    row
}
