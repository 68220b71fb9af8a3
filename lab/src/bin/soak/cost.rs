//! What sessions cost: allocations, fairness, and an idle daemon.

use std::time::{Duration, Instant};

use untangled::service::{self, ServeOptions, Shutdown};
use untangled_client::{Client, ClientOptions, Session};
use untangled_testkit::process::{ClientProcess, KnownCloth, PATIENCE, Programs, STEP, TestDomain};

use crate::{
    allocations,
    frames::{median, sheet},
    programs::PROGRAMS,
};

/// Allocations for each frame after warm-up, in the client's thread and in all threads of a daemon in this process.
pub(crate) fn allocations_per_frame() -> Vec<String> {
    const WINDOW: u64 = 100;
    let domain = TestDomain::new();
    let (options, shutdown) = (ServeOptions::new(domain.0.clone()), Shutdown::default());
    let ends = shutdown.clone();
    let daemon = std::thread::spawn(move || service::run(&options, &ends, || {}));
    let client = Client::connect(ClientOptions { domain: Some(domain.name().to_owned()), timeout: PATIENCE });
    let client = client.expect("a daemon in this process");
    let mut lines =
        vec!["| frames | client | daemon, whole | in 100 frames |".to_owned(), "|---|---|---|---|".to_owned()];
    let (registration, positions) = sheet(16_000);
    let tangled = KnownCloth::new(5_000);
    let mut flat = client.register(registration).expect("there is room");
    let mut scene = client.register(tangled.registration()).expect("there is room");
    let mut frame_of = |tangled_scene: bool| {
        if tangled_scene {
            drop(tangled.exchange(&mut scene, PATIENCE).expect("an answer"));
        } else {
            let exchanged = flat.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&positions));
            drop(exchanged.expect("an answer"));
        }
    };
    for (what, is_tangled, is_watched) in [
        ("no contact, 16,000 vertices", false, false),
        ("tangled, 5,000 vertices", true, false),
        ("no contact, watched", false, true),
        ("tangled, watched", true, true),
    ] {
        // In a process of its own, whose allocations are not counted.
        let watching = is_watched.then(|| {
            let role = if is_tangled { "observe1" } else { "observe0" };
            let mut observer = ClientProcess::start(PROGRAMS, &domain, role);
            observer.wait_for("at opened");
            observer
        });
        (0..200).for_each(|_| frame_of(is_tangled));
        let [own, others] = least_allocations(|| (0..WINDOW).for_each(|_| frame_of(is_tangled)));
        let per_frame = |count: u64| count as f64 / WINDOW as f64;
        lines.push(format!("| {what} | {} | {} | {own} + {others} |", per_frame(own), per_frame(others)));
        drop(watching);
    }
    drop((flat, scene, client));
    shutdown.request();
    let ended = daemon.join();
    assert!(ended.is_ok_and(|result| result.is_ok()), "the daemon ends well");
    lines
}

/// Allocations of a window of frames in this thread and in all others: the least of 30 windows, since housekeeping
/// allocates beside the frames twice a second, and some windows are without it.
fn least_allocations(mut window: impl FnMut()) -> [u64; 2] {
    let counts = (0..30).map(|_| {
        let before = [allocations::of_this_thread(), allocations::of_all_threads()];
        window();
        let [own, all] = [allocations::of_this_thread() - before[0], allocations::of_all_threads() - before[1]];
        [own, all - own]
    });
    counts.fold([u64::MAX; 2], |least, count| [least[0].min(count[0]), least[1].min(count[1])])
}

/// Latency of a session of 1,000 vertices alone, and beside one of 500,000 triangles that never rests.
pub(crate) fn fairness(programs: Programs) -> String {
    let domain = TestDomain::new();
    let _daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let (registration, positions) = sheet(1_000);
    let mut session = client.register(registration).expect("there is room");
    let alone = latencies(&mut session, &positions);
    let mut huge = ClientProcess::start(programs, &domain, "huge");
    huge.wait_for("at frame");
    let beside = latencies(&mut session, &positions);
    let frame_ms = client.status().ok().and_then(|status| {
        let sessions = status["sessions"].as_array()?.clone();
        sessions.iter().filter_map(|session| session["stage_us"]["total"].as_f64()).reduce(f64::max)
    });
    huge.kill();
    let [(alone, late), (beside, beside_late)] =
        [alone, beside].map(|times| (median(times.clone(), 0.5), median(times, 0.9)));
    format!(
        "1,000 vertices alone: median {alone:.0} us, 90 % within {late:.0} us. Beside a session of 500,000 triangles \
         whose frames take {:.0} ms each, without a pause: median {beside:.0} us, 90 % within {beside_late:.0} us. \
         Ratio of the medians {:.2}.",
        frame_ms.unwrap_or(f64::NAN) / 1e3,
        beside / alone
    )
}

/// The client process beside which others want to be served.
pub(crate) fn huge_main(domain: &str) {
    let options = ClientOptions { domain: Some(domain.to_owned()), timeout: PATIENCE };
    let client = Client::connect(options).expect("a daemon");
    let (registration, positions) = sheet(251_001);
    let mut session = client.register(registration).expect("there is room");
    while session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&positions)).is_ok() {
        println!("at frame");
    }
}

/// Times of 500 exchanges in microseconds.
pub(crate) fn latencies(session: &mut Session, positions: &[[f32; 3]]) -> Vec<f64> {
    let mut once = || {
        let begin = Instant::now();
        session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(positions)).expect("an answer");
        let time = begin.elapsed().as_secs_f64() * 1e6;
        std::thread::sleep(Duration::from_millis(4));
        time
    };
    (0..20).for_each(|_| {
        once();
    });
    (0..500).map(|_| once()).collect()
}

/// CPU time of a daemon with 32 sessions that rest.
pub(crate) fn idle(programs: Programs) -> String {
    let domain = TestDomain::new();
    let daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let cloth = KnownCloth::new(1_000);
    let mut sessions: Vec<Session> =
        (0..32).map(|_| client.register(cloth.registration()).expect("there is room")).collect();
    for session in &mut sessions {
        drop(cloth.exchange(session, PATIENCE).expect("an answer"));
    }
    // Until change detection trusts the times of the folders.
    std::thread::sleep(Duration::from_secs(4));
    let before = daemon.ticks();
    std::thread::sleep(Duration::from_secs(10));
    let ticks = daemon.ticks() - before;
    format!("32 sessions of 1,000 vertices at rest: {ticks} ticks (of 10 ms) of CPU time in 10 s.")
}
