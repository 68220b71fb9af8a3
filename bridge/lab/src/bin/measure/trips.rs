//! Round trips of one cloth at a time.

use std::time::{Duration, Instant};

use untangled_bridge_lab::{cloth::Fold, ends::PATIENCE, times::Times};
use untangled_client::{Registration, Session, StepTime};
use untangled_proto::correction::stage;

use crate::{
    link::Link,
    setting::{LARGE, Messages, Setting},
};

pub(crate) const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };

/// The round trip of a frame, and what of it is not the daemon's work on the frame.
fn exchange(session: &mut Session, cloth: &Fold) -> [Duration; 2] {
    let positions = cloth.positions_f32(session.frame() + 1);
    let begin = Instant::now();
    let answer = session.exchange(STEP, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
    let trip = begin.elapsed();
    [trip, trip.saturating_sub(Duration::from_nanos(answer.header().stage_ns[stage::TOTAL]))]
}

/// Heads of a table of round trips: all of it, and what is not the daemon's work.
const HEADS: &str = "| where | frames | median ms | 99 % within ms | longest ms | without work: median ms | 99 % ms |\n\
                     |---|---|---|---|---|---|---|";

fn row(name: &str, times: &mut [Times; 2]) {
    let [trip, way] = times;
    let [half, most, last] = [0.5, 0.99, 1.0].map(|part| trip.quantile_ms(part));
    let [way_half, way_most] = [0.5, 0.99].map(|part| way.quantile_ms(part));
    println!("| {name} | {} | {half:.2} | {most:.2} | {last:.2} | {way_half:.2} | {way_most:.2} |", trip.len());
}

fn add(times: &mut [Times; 2], [trip, way]: [Duration; 2]) {
    times[0].add(trip);
    times[1].add(way);
}

/// Round trips of a tangled cloth in lock step, over each link.
pub(crate) fn lockstep(frames: u64) {
    println!("{HEADS}");
    for link in Link::NEAR_AND_FAR {
        for sparse in [false, true] {
            lockstep_over(link, sparse, frames);
        }
    }
}

/// Beside the daemon and through the bridge, frame by frame in turn.
fn lockstep_over(link: Link<'_>, sparse: bool, frames: u64) {
    let setting = Setting::start(1, link, Messages::Clear);
    let registration = Registration { sparse, ..LARGE.registration() };
    let domains = [&setting.near_daemons[0], &setting.near_host];
    let mut sessions = domains.map(|domain| domain.connect().register(registration.clone()).unwrap());
    let mut times: [[Times; 2]; 2] = Default::default();
    for frame in 0..frames + 20 {
        for (session, times) in sessions.iter_mut().zip(&mut times) {
            let time = exchange(session, &LARGE);
            // The first frames search without separation certificates.
            if frame >= 20 {
                add(times, time);
            }
        }
    }
    let form = if sparse { "sparse" } else { "all vertices" };
    row(&format!("beside the daemon, {form}"), &mut times[0]);
    row(&format!("through the bridge, {form}: {}", setting.words), &mut times[1]);
    let [up, down] = setting.frame_bytes();
    println!("bytes of a frame: up {up:.0}, down {down:.0}");
}

/// 60 frames a second, over each link.
pub(crate) fn rate(seconds: u64) {
    println!("{HEADS}");
    for link in Link::NEAR_AND_FAR {
        let setting = Setting::start(1, link, Messages::Clear);
        for (name, domain) in
            [("beside the daemon", &setting.near_daemons[0]), ("through the bridge", &setting.near_host)]
        {
            let mut session = domain.connect().register(LARGE.registration()).unwrap();
            for _ in 0..20 {
                exchange(&mut session, &LARGE);
            }
            let (begin, mut times) = (Instant::now(), <[Times; 2]>::default());
            let before = setting.ticks();
            for frame in 0..60 * seconds {
                let due = begin + Duration::from_micros(frame * 16_667);
                std::thread::sleep(due.saturating_duration_since(Instant::now()));
                add(&mut times, exchange(&mut session, &LARGE));
            }
            let cost = cost_ms(&setting, &before, 60 * seconds);
            row(&format!("{name}, 60 frames a second: {}", setting.words), &mut times);
            println!("processor time of the ends in ms for each frame, daemon end and host end: {}", cost.join(", "));
        }
    }
}

/// Processor time of each end in milliseconds for each of so many frames.
fn cost_ms(setting: &Setting, before: &[u64], frames: u64) -> Vec<String> {
    let ticks = setting.ticks().into_iter().zip(before).map(|(now, before)| now - before);
    ticks.map(|ticks| format!("{:.2}", 10.0 * ticks as f64 / frames as f64)).collect()
}

/// What compression and encryption cost, at two rates, in lock step.
pub(crate) fn ways(frames: u64) {
    println!(
        "| link | messages | frames | median ms | 99 % within ms | without work: median ms | 99 % ms | \
         bytes up, down | daemon end, host end: ms of processor time |\n|---|---|---|---|---|---|---|---|---|"
    );
    let cloth = LARGE.turning();
    for rate in ["1gbit", "100mbit"] {
        for messages in Messages::ALL {
            let setting = Setting::start(1, Link::new(rate), messages);
            let mut session = setting.near_host.connect().register(cloth.registration()).unwrap();
            for _ in 0..20 {
                exchange(&mut session, &cloth);
            }
            let (mut times, before) = (<[Times; 2]>::default(), setting.ticks());
            for _ in 0..frames {
                add(&mut times, exchange(&mut session, &cloth));
            }
            let cost = cost_ms(&setting, &before, frames);
            let [half, most, way_half, way_most] =
                [(0, 0.5), (0, 0.99), (1, 0.5), (1, 0.99)].map(|(which, part)| times[which].quantile_ms(part));
            let [up, down] = setting.frame_bytes();
            println!(
                "| {} | {} | {frames} | {half:.2} | {most:.2} | {way_half:.2} | {way_most:.2} | {up:.0}, {down:.0} \
                 | {} |",
                setting.words,
                messages.words(),
                cost.join(", ")
            );
        }
    }
}

/// A host with one daemon and with three, each of which has a session: frames of all sessions in turn.
pub(crate) fn hosts(frames: u64) {
    println!("{HEADS}");
    for num_daemons in [1, 3] {
        let setting = Setting::start(num_daemons, Link::GIGABIT, Messages::Clear);
        let register = |_| setting.near_host.connect().register(LARGE.registration()).unwrap();
        let mut sessions: Vec<Session> = (0..num_daemons).map(register).collect();
        let mut times = <[Times; 2]>::default();
        for frame in 0..frames + 20 {
            for session in &mut sessions {
                let time = exchange(session, &LARGE);
                if frame >= 20 {
                    add(&mut times, time);
                }
            }
        }
        let served = setting.places().len();
        row(&format!("{} hosts, sessions on {served} of them: {}", num_daemons + 1, setting.words), &mut times);
    }
}
