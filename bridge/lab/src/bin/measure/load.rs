//! Many frames, and many sessions.

use std::time::{Duration, Instant};

use untangled_bridge_lab::{ends::PATIENCE, times::Times};
use untangled_client::{CorrectionHeader, Precision, Registration, Session};

use crate::{
    link::Link,
    setting::{LARGE, Messages, SMALL, Setting},
    trips::STEP,
};

/// The same bytes beside the daemon and through the bridge.
pub(crate) fn same(frames: u64) {
    let setting = Setting::start(1, Link::GIGABIT, Messages::Clear);
    let domains = [&setting.near_daemons[0], &setting.near_host];
    let mut sessions = domains.map(|domain| domain.connect().register(LARGE.registration()).unwrap());
    let (mut differ, mut tangled) = (0, 0);
    for frame in 1..=frames {
        let positions = LARGE.positions_f32(frame);
        let [own, far] = sessions.each_mut().map(|session| {
            let answer = session.exchange(STEP, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
            let header = CorrectionHeader { stage_ns: [0; 8], ..*answer.header() };
            let bits: Vec<_> = answer.vertices().iter().map(|v| (v.value.map(f32::to_bits), v.flags)).collect();
            (header, bits)
        });
        differ += u64::from(own != far);
        tangled += u64::from(own.0.num_face_pairs > 0);
    }
    println!("{frames} frames of 31,250 triangles, {tangled} tangled: {differ} differ ({})", setting.words);
}

/// Sessions of 7,938 triangles at 30 frames a second each, for ten seconds: how many frames came in time. `apart` is
/// cloth that does not intersect, in double precision: more bytes for less work.
pub(crate) fn capacity(num_daemons: usize, num_sessions: u64, rate: &str, apart: bool) {
    let setting = Setting::start(num_daemons, Link::new(rate).in_bursts(), Messages::Clear);
    let cloth = if apart { SMALL.apart() } else { SMALL };
    let precision = if apart { Precision::F64 } else { Precision::F32 };
    let registration = Registration { sparse: true, precision, ..cloth.registration() };
    let register = |_| setting.near_host.connect().register(registration.clone()).unwrap();
    let sessions: Vec<Session> = (0..num_sessions).map(register).collect();
    let shares: Vec<String> = setting.places().iter().map(ToString::to_string).collect();
    // Not while frames are due: hosts have their simulators for that.
    let frames: &[Positions] =
        &(0..FRAMES).map(|frame| (cloth.positions_f32(frame), cloth.positions(frame))).collect::<Vec<_>>();
    let begin = Instant::now() + Duration::from_secs(1);
    let (mut times, mut late) = (Times::default(), 0);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..num_sessions)
            .zip(sessions)
            // Hosts do not step at the same instant.
            .map(|(k, session)| {
                (begin + PERIOD * u32::try_from(k).unwrap() / u32::try_from(num_sessions).unwrap(), session)
            })
            .map(|(begin, session)| scope.spawn(move || steps(session, begin, frames, precision)))
            .collect();
        for thread in threads {
            let (own, own_late) = thread.join().unwrap();
            times.append(own);
            late += own_late;
        }
    });
    let all = times.len() as u64 + late;
    let [half, most] = [0.5, 0.99].map(|part| times.quantile_ms(part));
    let [up, _] = setting.frame_bytes();
    println!(
        "| {num_daemons} | {rate} | {num_sessions} ({}) | {up:.0} | {all} | {late} | {half:.2} | {most:.2} | {} |",
        shares.join(" + "),
        setting.words
    );
}

/// Frames of each session, and the time from one to the next.
const FRAMES: u64 = 300;
const PERIOD: Duration = Duration::from_micros(33_333);

/// Positions of a frame in single and in double precision.
type Positions = (Vec<[f32; 3]>, Vec<[f64; 3]>);

/// A host in lock step: times of the frames that were answered in time, and how many were not.
fn steps(mut session: Session, begin: Instant, frames: &[Positions], precision: Precision) -> (Times, u64) {
    let (mut times, mut late) = (Times::default(), 0);
    for (frame, (single, double)) in (0..).zip(frames) {
        let due = begin + PERIOD * frame;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        let sent = Instant::now();
        let is_answered = match precision {
            Precision::F32 => session.exchange(STEP, PERIOD, |to| to.copy_from_slice(single)).is_ok(),
            Precision::F64 => session.exchange_f64(STEP, PERIOD, |to| to.copy_from_slice(double)).is_ok(),
        };
        if is_answered { times.add(sent.elapsed()) } else { late += 1 }
    }
    (times, late)
}
