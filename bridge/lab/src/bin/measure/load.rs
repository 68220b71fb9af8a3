//! Many frames, and many sessions.

use std::time::{Duration, Instant};

use untangled_bridge_lab::{ends::PATIENCE, times::Times};
use untangled_client::{CorrectionHeader, Registration};

use crate::{
    setting::{LARGE, Messages, SMALL, Setting},
    trips::STEP,
};

/// The same bytes beside the daemon and through the bridge.
pub(crate) fn same(frames: u64) {
    let setting = Setting::start(1, "1gbit", Messages::Clear);
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

/// Sessions of 7,938 triangles at 30 frames a second each, for ten seconds: how many frames came in time.
pub(crate) fn capacity(num_daemons: usize, num_sessions: u64, rate: &str) {
    let setting = Setting::start(num_daemons, rate, Messages::Clear);
    let registration = Registration { sparse: true, ..SMALL.registration() };
    let begin = Instant::now() + Duration::from_secs(3);
    let threads: Vec<_> = (0..num_sessions)
        .map(|k| {
            let client = setting.near_host.connect();
            let mut session = client.register(registration.clone()).unwrap();
            std::thread::spawn(move || {
                let (mut times, mut late) = (Times::default(), 0u64);
                for frame in 0..300 {
                    // Hosts do not step at the same instant.
                    let due = begin + Duration::from_micros(33_333 * frame + 33_333 * k / num_sessions);
                    std::thread::sleep(due.saturating_duration_since(Instant::now()));
                    let positions = SMALL.positions_f32(frame);
                    let sent = Instant::now();
                    let answer = session.exchange(STEP, Duration::from_millis(33), |to| to.copy_from_slice(&positions));
                    match answer {
                        Ok(_) => times.add(sent.elapsed()),
                        Err(_) => late += 1,
                    }
                }
                (times, late)
            })
        })
        .collect();
    let shares: Vec<String> = setting.places().iter().map(ToString::to_string).collect();
    let (mut times, mut late) = (Times::default(), 0);
    for thread in threads {
        let (own, own_late) = thread.join().unwrap();
        times.append(own);
        late += own_late;
    }
    let all = times.len() as u64 + late;
    let [half, most] = [0.5, 0.99].map(|part| times.quantile_ms(part));
    println!(
        "| {num_daemons} | {rate} | {num_sessions} ({}) | {all} | {late} | {half:.2} | {most:.2} | {} |",
        shares.join(" + "),
        setting.words
    );
}
