//! Frames of peers that don't keep to the rules: each gets one answer, and others don't notice.

use std::sync::atomic::{AtomicBool, Ordering};

use rand::{RngExt, SeedableRng, rngs::StdRng};
use untangled_proto::{CorrectionHeader, PositionF32, SessionOptions, StateHeader, Status, VertexCorrection, names};

use super::{
    row::Row,
    witness::{bystanders, finish},
};
use crate::process::{Programs, RawPeer, RawSession};

/// Frames whose headers and lengths lie.
pub fn lying_headers(programs: Programs, num_tries: u64, seed: u64) -> Row {
    lies("frame whose header or length lies", 0, programs, num_tries, seed)
}

/// The same in a session that may ask for repairs, and does for every other frame, but never takes one.
pub fn lying_repair_requests(programs: Programs, num_tries: u64, seed: u64) -> Row {
    lies("request for a repair whose header or length lies", SessionOptions::REPAIR.bits(), programs, num_tries, seed)
}

fn lies(what: &str, options: u32, programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: what.into(), num_tries, ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    let session = peer.session_with(64, options);
    let mut num_accepted = 0;
    for frame in 1..=num_tries {
        let is_usable = send_lie(&session, frame, &mut rng);
        peer.wake(names::EVENT_STATE);
        let Some((answer, values)) = peer.answer(&session, frame) else {
            row.num_lost += 1;
            continue;
        };
        let zeros = values.iter().all(|vertex| *vertex == VertexCorrection::default());
        let right = match Status::from_code(answer.status) {
            Some(Status::Ok) => is_usable && values.len() == 3,
            Some(Status::BadHeader | Status::BadPosition) => !is_usable && zeros,
            _ => false,
        };
        num_accepted += u64::from(answer.status == 0);
        row.num_frames += 1;
        row.num_wrong += u64::from(!right);
    }
    row.note = format!("{num_accepted} could be used and were, the others were refused with a status");
    drop((session, peer));
    finish(&domain, daemon, witness, &mut row);
    row
}

/// Sends a frame of wild numbers under a header that may lie; returns whether it can be used all the same.
fn send_lie(session: &RawSession, frame: u64, rng: &mut StdRng) -> bool {
    let length = if rng.random_bool(0.5) { 3 } else { rng.random_range(0..=64) };
    let honest = rng.random_bool(0.3);
    let mut sample = session.states.loan_slice_uninit(length).expect("a loan");
    *sample.user_header_mut() = StateHeader {
        frame,
        simulated_s: if honest { 1.0 } else { wild(rng) },
        dt_s: if honest { 0.01 } else { wild(rng) },
        num_vertices: if rng.random_bool(0.7) { 3 } else { rng.random() },
        flags: rng.random(),
        progress: rng.random(),
        repair_deadline_us: rng.random(),
        reserved: rng.random(),
    };
    let sample = sample.write_from_fn(|_| PositionF32(std::array::from_fn(|_| wild(rng) as f32)));
    let (sent, honest_length) = (*sample.user_header(), sample.payload().len() == 3);
    let finite = sample.payload().iter().flat_map(|position| position.0).all(f32::is_finite);
    sample.send().expect("a subscriber");
    honest_length
        && finite
        && sent.num_vertices == 3
        && (1e-9..=1e9).contains(&sent.dt_s)
        && sent.simulated_s.is_finite()
}

/// A client that goes on writing into samples that it has sent.
pub fn writing_after_sending(programs: Programs, num_tries: u64, seed: u64) -> Row {
    let mut rng = StdRng::seed_from_u64(seed);
    let mut row = Row { what: "sample written to after it was sent".into(), num_tries, ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    let session = peer.session(3);
    let mut num_refused = 0;
    for frame in 1..=num_tries {
        let garbage = std::array::from_fn(|_| (wild(&mut rng) as f32).to_bits());
        let answer = answer_while_writing(&peer, &session, frame, garbage);
        let Some((answer, values)) = answer else {
            row.num_lost += 1;
            continue;
        };
        row.num_frames += 1;
        num_refused += u64::from(answer.status != 0);
        let right =
            matches!(Status::from_code(answer.status), Some(Status::Ok | Status::BadPosition | Status::BadHeader));
        let finite = values.iter().flat_map(|vertex| vertex.value).all(f32::is_finite);
        row.num_wrong += u64::from(!right || !finite || values.len() != 3);
    }
    row.note = format!("{num_refused} refused, the others answered with finite numbers");
    drop((session, peer));
    finish(&domain, daemon, witness, &mut row);
    row
}

/// Sends a frame of 3 vertices, and overwrites its positions and the number of vertices in its header until the answer
/// comes.
fn answer_while_writing(
    peer: &RawPeer,
    session: &RawSession,
    frame: u64,
    garbage: [u32; 9],
) -> Option<(CorrectionHeader, Vec<VertexCorrection>)> {
    let mut sample = session.states.loan_slice_uninit(3).expect("a loan");
    let memory = sample.payload_mut().as_mut_ptr().cast::<f32>() as usize;
    *sample.user_header_mut() = StateHeader { frame, dt_s: 0.01, num_vertices: 3, ..StateHeader::default() };
    let header = std::ptr::from_mut(sample.user_header_mut()) as usize;
    sample.write_from_fn(|k| PositionF32([k as f32, (k * k) as f32, 0.0])).send().expect("a subscriber");
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                for (k, bits) in garbage.iter().enumerate() {
                    // SAFETY: the sample's memory stays mapped while the port lives. That the daemon reads it meanwhile
                    // is the point.
                    unsafe { (memory as *mut u32).add(k).write_volatile(*bits) };
                }
                // SAFETY: as above; the number of vertices is the header's fourth field.
                unsafe { (header as *mut u32).add(6).write_volatile(garbage[0]) };
                std::hint::spin_loop();
            }
        });
        peer.wake(names::EVENT_STATE);
        let answer = peer.answer(session, frame);
        done.store(true, Ordering::Relaxed);
        answer
    })
}

/// A float of any kind, often an extreme one.
fn wild(rng: &mut StdRng) -> f64 {
    let special =
        [0.0, -0.0, f64::NAN, f64::INFINITY, -f64::INFINITY, f64::MIN_POSITIVE, f64::MAX, 1e-300, 1e-9, 1e9, 1.0];
    match rng.random_range(0..3) {
        0 => special[rng.random_range(0..special.len())],
        1 => f64::from_bits(rng.random()),
        _ => rng.random_range(-2.0..2.0),
    }
}
