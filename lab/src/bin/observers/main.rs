//! What observers cost a session: its round trips without any, with one, and with five of which one is stopped.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin observers
//! ```
//!
//! Daemon and observers are processes of this program. The host sends its next frame as soon as it has a correction, so
//! that nothing that the daemon does for observers is hidden by a pause. Other programs' load hits all rows: they take
//! turns, and a ratio is that of two neighbours.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    reason = "prints a table; what goes wrong ends it; counts are small"
)]

mod processes;

use std::time::Instant;

use rustix::process::Signal;
use untangled_client::{Registration, Session};
use untangled_lab::{
    daemon::{daemon, serve},
    table::{print_header, print_text},
};
use untangled_testkit::process::{KnownCloth, PATIENCE, Programs, STEP, TestDomain, fill_flat, sheet};

use processes::{Observers, Row};

/// Times that all rows are measured; they take turns.
const ROUNDS: usize = 12;
/// Frames of each row in each round.
const FRAMES: usize = 150;
/// Microseconds of a tick.
const TICK_US: f64 = 1e4;
/// Frames before, in which trees are built and memory is touched.
const WARM_UP: usize = 30;

/// Who watches, row by row.
const ROWS: [Row; 5] = [
    Row { name: "none", num_observers: 0, rate_hz: 0, is_one_stopped: false },
    Row { name: "one, 10 frames a second", num_observers: 1, rate_hz: 10, is_one_stopped: false },
    Row { name: "five, 10 frames a second, one stopped", num_observers: 5, rate_hz: 10, is_one_stopped: true },
    Row { name: "one, every frame", num_observers: 1, rate_hz: 0, is_one_stopped: false },
    Row { name: "five, every frame, one stopped", num_observers: 5, rate_hz: 0, is_one_stopped: true },
];

fn main() {
    match &std::env::args().collect::<Vec<_>>()[..] {
        [_, role, domain] if role == "daemon" => serve(domain),
        [_, role, domain, rate_hz] if role == "observe" => processes::watch(domain, rate_hz.parse().unwrap()),
        _ => measure(),
    }
}

fn measure() {
    print_text(&format!(
        "Round trips of sessions without a pause between frames, from before writing to having the correction, by who \
         watches: medians of {ROUNDS} rounds of {FRAMES} frames. The ratio is the median of those of each round to its \
         row without observers. Beside it the processor time of the daemon for a frame, which other programs change \
         little.\n"
    ));
    print_header(&["session", "observers", "microseconds", "ratio", "of most rounds", "daemon, microseconds"]);
    // 31,250 triangles: flat, so that a frame is as short as it gets, and with a strip through a sheet.
    let flat: Registration = sheet(125);
    table("no contact", flat, |_, positions| fill_flat(positions));
    let cloth = KnownCloth::new(15_850);
    table("tangled", cloth.registration(), |frame, positions| positions.copy_from_slice(cloth.positions(frame)));
}

fn table(name: &str, registration: Registration, fill: impl Fn(u64, &mut [[f32; 3]])) {
    let num_triangles = registration.triangles.len();
    let domain = TestDomain::new();
    let client_role = |_: &str, _: &str| unreachable!("no client is a process of this program");
    let daemon = Programs { daemon, client: client_role }.start_daemon(&domain);
    let mut session = domain.connect().register(registration).unwrap();
    let frame = |session: &mut Session| {
        let number = session.frame() + 1;
        let begin = Instant::now();
        drop(session.exchange(STEP, PATIENCE, |positions| fill(number, positions)).unwrap());
        begin.elapsed().as_secs_f64() * 1e6
    };
    let (mut medians, mut ticks) = (ROWS.map(|_| Vec::new()), ROWS.map(|_| 0));
    for _ in 0..ROUNDS {
        for ((row, medians), ticks) in ROWS.iter().zip(&mut medians).zip(&mut ticks) {
            let observers = Observers::start(row, &domain, || {
                frame(&mut session);
            });
            (0..WARM_UP).for_each(|_| {
                frame(&mut session);
            });
            let before = daemon.ticks();
            medians.push(middle((0..FRAMES).map(|_| frame(&mut session)).collect()));
            *ticks += daemon.ticks() - before;
            observers.end(&domain);
        }
    }
    for ((row, own), ticks) in ROWS.iter().zip(&medians).zip(ticks) {
        let ratios: Vec<f64> = own.iter().zip(&medians[0]).map(|(own, none)| own / none).collect();
        let mut sorted = ratios.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let [low, high] = [sorted[ROUNDS / 5], sorted[ROUNDS - 1 - ROUNDS / 5]];
        println!(
            "| {name}, {num_triangles} triangles | {} | {:.0} | {:.3} | {low:.3} to {high:.3} | {:.0} |",
            row.name,
            middle(own.clone()),
            middle(ratios),
            ticks as f64 * TICK_US / (ROUNDS * FRAMES) as f64,
        );
    }
    drop(session);
    assert!(daemon.stop(Signal::TERM).success());
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
