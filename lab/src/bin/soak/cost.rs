//! What the way through shared memory costs: time beside a Unix socket, allocations, fairness, and an idle daemon.

use std::{
    io::{Read, Write},
    os::unix::net::{UnixListener, UnixStream},
    process::Command,
    time::{Duration, Instant},
};

use untangled::service::{self, ServeOptions, Shutdown};
use untangled_client::{Client, ClientOptions, Registration, Session};
use untangled_proto::{CorrectionHeader, StateHeader, VertexCorrection, correction::stage};

use super::{
    allocations,
    processes::{ClientProcess, Daemon, PATIENCE, Programs, TestDomain},
    scene::{STEP, Scene},
};

const HEADERS: [usize; 2] = [size_of::<StateHeader>(), size_of::<CorrectionHeader>()];

/// A sheet in slight waves of some `num_vertices` vertices, without any contact, and its positions.
fn sheet(num_vertices: usize) -> (Registration, Vec<[f32; 3]>) {
    let side = num_vertices.isqrt();
    let at = |k: usize| {
        let [x, y] = [(k % side) as f32 * 0.01, (k / side) as f32 * 0.01];
        [x, y, 0.05 * (2.0 * x).sin() * (3.0 * y).cos()]
    };
    let positions: Vec<[f32; 3]> = (0..side * side).map(at).collect();
    let squares = (0..(side - 1) * (side - 1)).map(|k| (k / (side - 1) * side + k % (side - 1)) as u32);
    let triangles = squares.flat_map(|a| {
        let c = a + side as u32;
        [[a, a + 1, c], [c, a + 1, c + 1]]
    });
    let registration =
        Registration { num_vertices: side * side, triangles: triangles.collect(), ..Registration::default() };
    (registration, positions)
}

fn median(mut times: Vec<f64>, part: f64) -> f64 {
    times.sort_by(f64::total_cmp);
    times[((times.len() - 1) as f64 * part) as usize]
}

/// Round trip less compute, beside a Unix socket that copies the same bytes: lines of a Markdown table.
pub fn round_trips(programs: Programs, echo: fn(&str, usize) -> Command) -> Vec<String> {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(programs, &domain, &[]);
    let client = domain.connect();
    let mut lines = vec![
        "| vertices | round trip us | of it compute us | round trip less compute us | Unix socket us | ratio |"
            .to_owned(),
        "|---|---|---|---|---|---|".to_owned(),
    ];
    for num_vertices in [1_000, 16_000, 250_000] {
        let (registration, positions) = sheet(num_vertices);
        let n = positions.len();
        let mut session = client.register(registration).expect("there is room");
        let mut socket = Echo::start(echo, n);
        let num_frames = if n > 100_000 { 60 } else { 400 };
        let (mut trips, mut less, mut compute, mut sockets) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for frame in 0..num_frames + 20 {
            let begin = Instant::now();
            let correction =
                session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&positions)).expect("an answer");
            // A host reads what it got.
            let sum: f32 = correction.vertices().iter().map(|vertex| vertex.value[0]).sum();
            let trip = std::hint::black_box((begin.elapsed(), sum)).0.as_secs_f64() * 1e6;
            let stages = &correction.header().stage_ns[stage::INTERSECT..=stage::RESPOND];
            let computing = stages.iter().sum::<u64>() as f64 / 1e3;
            drop(correction);
            let begin = Instant::now();
            socket.exchange(&positions);
            let by_socket = begin.elapsed().as_secs_f64() * 1e6;
            // The first frames build trees and touch memory.
            if frame >= 20 {
                trips.push(trip);
                less.push(trip - computing);
                compute.push(computing);
                sockets.push(by_socket);
            }
        }
        let [trip, compute, less, by_socket] = [trips, compute, less, sockets].map(|times| median(times, 0.5));
        lines
            .push(format!("| {n} | {trip:.0} | {compute:.0} | {less:.0} | {by_socket:.0} | {:.2} |", less / by_socket));
    }
    lines
}

/// A process that answers states with corrections of zeros over a Unix socket.
struct Echo {
    stream: UnixStream,
    child: std::process::Child,
    out: Vec<u8>,
    answer: Vec<u8>,
}

impl Echo {
    fn start(program: fn(&str, usize) -> Command, num_vertices: usize) -> Self {
        let path = std::env::temp_dir().join(format!("untangled-echo-{}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path).expect("a socket");
        let child = program(&path.to_string_lossy(), num_vertices).spawn().expect("this program");
        let (stream, _) = listener.accept().expect("the child connects");
        let _ = std::fs::remove_file(&path);
        let [state, correction] = HEADERS;
        let answer = vec![0; correction + num_vertices * size_of::<VertexCorrection>()];
        Self { stream, child, out: vec![0; state], answer }
    }

    fn exchange(&mut self, positions: &[[f32; 3]]) {
        self.out.truncate(HEADERS[0]);
        self.out.extend(positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        self.stream.write_all(&self.out).expect("the child reads");
        self.stream.read_exact(&mut self.answer).expect("the child answers");
        std::hint::black_box(&self.answer);
    }
}

impl Drop for Echo {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The other end of [`Echo`].
pub fn echo_main(path: &str, num_vertices: usize) {
    let mut stream = UnixStream::connect(path).expect("the parent listens");
    let mut state = vec![0; HEADERS[0] + num_vertices * 12];
    let correction = vec![0; HEADERS[1] + num_vertices * size_of::<VertexCorrection>()];
    while stream.read_exact(&mut state).is_ok() && stream.write_all(&correction).is_ok() {}
}

/// Allocations for each frame after warm-up, in the client's thread and in all threads of a daemon in this process.
pub fn allocations_per_frame() -> Vec<String> {
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
    let tangled = Scene::new(5_000);
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
    for (what, is_tangled) in [("no contact, 16,000 vertices", false), ("tangled, 5,000 vertices", true)] {
        (0..200).for_each(|_| frame_of(is_tangled));
        // Twice a second housekeeping allocates beside the frames; some windows are without.
        let windows = (0..30).map(|_| {
            let before = [allocations::of_this_thread(), allocations::of_all_threads()];
            (0..WINDOW).for_each(|_| frame_of(is_tangled));
            let [own, all] = [allocations::of_this_thread() - before[0], allocations::of_all_threads() - before[1]];
            [own, all - own]
        });
        let windows: Vec<[u64; 2]> = windows.collect();
        let least = |k: usize| windows.iter().map(|window| window[k]).min().unwrap_or(0);
        let per_frame = |count: u64| count as f64 / WINDOW as f64;
        lines.push(format!(
            "| {what} | {} | {} | {} + {} |",
            per_frame(least(0)),
            per_frame(least(1)),
            least(0),
            least(1)
        ));
    }
    drop((flat, scene, client));
    shutdown.request();
    let ended = daemon.join();
    assert!(ended.is_ok_and(|result| result.is_ok()), "the daemon ends well");
    lines
}

/// Latency of a session of 1,000 vertices alone, and beside one of 500,000 triangles that never rests.
pub fn fairness(programs: Programs) -> String {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(programs, &domain, &[]);
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
        "1,000 vertices alone: median {alone:.0} us, 90 % within {late:.0} us. Beside a session of 500,000 triangles whose frames take \
         {:.0} ms each, without a pause: median {beside:.0} us, 90 % within {beside_late:.0} us. Ratio of the medians {:.2}.",
        frame_ms.unwrap_or(f64::NAN) / 1e3,
        beside / alone
    )
}

/// The client process beside which others want to be served.
pub fn huge_main(domain: &str) {
    let options = ClientOptions { domain: Some(domain.to_owned()), timeout: PATIENCE };
    let client = Client::connect(options).expect("a daemon");
    let (registration, positions) = sheet(251_001);
    let mut session = client.register(registration).expect("there is room");
    while session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&positions)).is_ok() {
        println!("at frame");
    }
}

fn latencies(session: &mut Session, positions: &[[f32; 3]]) -> Vec<f64> {
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
pub fn idle(programs: Programs) -> String {
    let domain = TestDomain::new();
    let daemon = Daemon::start(programs, &domain, &[]);
    let client = domain.connect();
    let scene = Scene::new(1_000);
    let mut sessions: Vec<Session> =
        (0..32).map(|_| client.register(scene.registration()).expect("there is room")).collect();
    for session in &mut sessions {
        drop(scene.exchange(session, PATIENCE).expect("an answer"));
    }
    // Until what was just opened counts as settled.
    std::thread::sleep(Duration::from_secs(4));
    let before = daemon.ticks();
    std::thread::sleep(Duration::from_secs(10));
    let ticks = daemon.ticks() - before;
    format!("32 sessions of 1,000 vertices at rest: {ticks} ticks (of 10 ms) of CPU time in 10 s.")
}
