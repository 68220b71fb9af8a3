//! Time, memory and size: deadlines, fairness, idling.

use std::time::{Duration, Instant};

use serde_json::json;
use untangled_client::{FrameRefusal, NewestError, Registration, Session, Status, flags};
use untangled_proto::correction::TRUNCATED;
use untangled_testkit::process::{Daemon, PATIENCE, STEP, TestDomain, fill_flat, sheet};

use crate::machine::{busy, quiet};

/// Events of many clients at once are what the transport loses wake-ups by; the daemon's tick, twice a second, must not
/// be what serves them.
#[test]
fn daemon_under_a_crowd_of_clients_does_not_wait_for_its_tick() {
    const CLIENTS: usize = 8;
    const FRAMES: usize = 500;
    let _guard = quiet();
    let tick = Duration::from_millis(400);
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let num_slow: usize = std::thread::scope(|scope| {
        let clients: Vec<_> = (0..CLIENTS)
            .map(|_| {
                scope.spawn(|| {
                    let mut session = domain.connect().register(sheet(1)).unwrap();
                    let mut num_slow = 0;
                    for _ in 0..FRAMES {
                        let begin = Instant::now();
                        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
                        num_slow += usize::from(begin.elapsed() > tick);
                    }
                    num_slow
                })
            })
            .collect();
        clients.into_iter().map(|client| client.join().unwrap()).sum()
    });
    // A machine may stand still for a moment, but not for one frame in a hundred.
    assert!(num_slow < CLIENTS * FRAMES / 100, "{num_slow} of {} frames waited for a tick", CLIENTS * FRAMES);
}

/// An upright triangle whose tip stands through a flat one.
fn fill_tangled(positions: &mut [[f32; 3]]) {
    positions.copy_from_slice(&[
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.5, 1.0, 2.0],
        [1.5, 1.0, 2.0],
        [1.0, 1.1, -1.0],
    ]);
}

#[test]
fn frame_beyond_its_deadline_ends_and_reports_left_out_pairs() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let tangle = Registration { num_vertices: 6, triangles: vec![[0, 1, 2], [3, 4, 5]], ..Registration::default() };
    // No frame is that fast.
    let hurried = Registration { settings: json!({"deadline_us": 1}), ..tangle };
    let mut session = client.register(hurried).unwrap();
    let correction = session.exchange(STEP, PATIENCE, fill_tangled).unwrap();
    let header = *correction.header();
    assert_eq!((header.status, header.flags & TRUNCATED, header.num_pairs_left_out), (0, TRUNCATED, 1));
    assert!((header.length_left_out_m - header.contour_length_m).abs() < 1e-12 && header.length_left_out_m > 0.1);
    assert!(correction.vertices().iter().all(|vertex| vertex.value == [0.0; 3]));
    assert_eq!(header.num_face_pairs, 1, "what intersects is always found");
    assert_ne!(correction.vertices()[5].flags & flags::MASK, 0, "the mask holds all the same");
    // Changed while it runs: each kind of setting from the next frame on.
    for (settings, moves) in [
        (json!({}), true),
        (json!({"quality": "fast"}), true),
        (json!({"quality": "accurate", "deadline_us": 1}), false),
        (json!({"quality": "fast", "response": "mask"}), false),
        (json!({"quality": "balanced"}), true),
    ] {
        session.update_settings(settings.clone(), PATIENCE).unwrap();
        let correction = session.exchange(STEP, PATIENCE, fill_tangled).unwrap();
        let header = correction.header();
        assert_eq!(header.num_pairs_left_out, u64::from(settings["deadline_us"] == 1), "{settings}");
        assert_eq!(header.flags & TRUNCATED != 0, header.num_pairs_left_out > 0);
        assert_eq!(correction.vertices()[5].value != [0.0; 3], moves, "{settings}");
    }
    let status = client.status().unwrap();
    assert_eq!(status["sessions"][0]["num_truncated_frames"], 2);
}

/// Every triangle as large as the scene.
fn fill_exploded(positions: &mut [[f32; 3]]) {
    let mut state = 7u32;
    for coordinate in positions.iter_mut().flatten() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *coordinate = f32::from(u16::try_from(state >> 16).unwrap());
    }
}

/// The refusal of one frame, while another session gets its corrections.
fn refusal(session: &mut Session, other: &mut Session, fill: fn(&mut [[f32; 3]])) -> FrameRefusal {
    let frame = session.publish(STEP, fill).unwrap();
    let mut num_others = 0;
    loop {
        other.exchange(STEP, PATIENCE, fill_flat).unwrap();
        num_others += 1;
        match session.newest() {
            Ok(None) => {}
            Ok(Some(_)) => panic!("frame {frame} was answered as any other"),
            Err(NewestError::Refused(refusal)) => {
                assert!(num_others > 0 && refusal.frame == frame);
                return refusal;
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn frame_in_which_everything_meets_ends_truncated_while_others_are_served() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let mut other = domain.connect().register(sheet(10)).unwrap();
    let mut session = client.register(sheet(60)).unwrap();
    let fill_zero = |positions: &mut [[f32; 3]]| positions.fill([0.0; 3]);
    for fill in [fill_exploded, fill_zero] {
        let refusal = refusal(&mut session, &mut other, fill);
        assert_eq!((refusal.status, refusal.fault_value), (Status::TooManyIntersections, 131_072.0));
        assert!(refusal.to_string().contains("more faces intersect than the limit allows, 131072 pairs"));
    }
    session.update_settings(json!({"deadline_us": 8000, "max_face_pairs": 1_000_000_000_000u64}), PATIENCE).unwrap();
    for fill in [fill_exploded, fill_zero] {
        let begin = Instant::now();
        let refusal = refusal(&mut session, &mut other, fill);
        assert_eq!((refusal.status, refusal.fault_value), (Status::OutOfTime, 8000.0));
        // On a machine that does many things at a time, and with code that is hardly optimised.
        assert!(begin.elapsed() < Duration::from_secs(2), "{:?}", begin.elapsed());
    }
    session.update_settings(json!({}), PATIENCE).unwrap();
    let correction = session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    assert_eq!((correction.header().status, correction.header().flags), (0, 0));
    let status = client.status().unwrap();
    let counts =
        |key: &str| status["sessions"].as_array().unwrap().iter().map(|s| s[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!((counts("num_truncated_frames"), counts("num_refused_frames")), (4, 0));
}

#[test]
fn small_session_beside_a_large_one_is_served_meanwhile() {
    let _guard = quiet();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut large = domain.connect().register(sheet(500)).unwrap();
    let mut small = domain.connect().register(sheet(10)).unwrap();
    let mut most_while_one = 0;
    for _ in 0..5 {
        let frame = large.publish(STEP, fill_flat).unwrap();
        let mut num_small = 0;
        let done = loop {
            small.exchange(STEP, PATIENCE, fill_flat).unwrap();
            match large.newest().unwrap() {
                Some(correction) => break correction,
                None => num_small += 1,
            }
        };
        assert_eq!(done.frame(), frame);
        most_while_one = most_while_one.max(num_small);
    }
    // With one worker for both there would be one at most.
    assert!(most_while_one > 3, "{most_while_one} small frames while a large one was at work");
}

#[test]
fn frames_after_registration_take_no_more_shared_memory() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(200)).unwrap();
    let taken = domain.shared_bytes();
    let mut held = Vec::new();
    for frame in 0..12 {
        held.push(session.exchange(STEP, PATIENCE, fill_flat).unwrap());
        if frame % 4 == 3 {
            held.clear();
        } else if held.len() == 3 {
            held.remove(0);
        }
    }
    // A page or so of bookkeeping; a sample that was not taken would be a hundred of them.
    assert!(domain.shared_bytes() <= taken + 65536, "{taken} bytes at first, {} later", domain.shared_bytes());
}

#[test]
fn session_of_a_million_triangles_exchanges_a_frame() {
    let _guard = busy();
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(708)).unwrap();
    let correction = session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    assert_eq!(correction.vertices().len(), 709 * 709);
}

#[test]
fn daemon_with_an_idle_session_uses_no_processor_time() {
    let _guard = quiet();
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    // One window of several with at most one tick: on a busy machine even housekeeping may be charged more.
    let used: Vec<u64> = (0..5)
        .map(|_| {
            let before = daemon.ticks();
            std::thread::sleep(Duration::from_secs(2));
            daemon.ticks() - before
        })
        .take_while(|&used| used > 1)
        .collect();
    assert!(used.len() < 5, "ticks of CPU time while idle, in windows of two seconds: {used:?}");
}
