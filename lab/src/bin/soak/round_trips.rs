//! Time of a round trip through shared memory, beside a Unix socket.

use std::{
    io::{Read, Write},
    os::unix::net::{UnixListener, UnixStream},
    process::Command,
    time::Instant,
};

use untangled_client::Session;
use untangled_proto::{CorrectionHeader, StateHeader, VertexCorrection, correction::stage};
use untangled_testkit::process::{PATIENCE, Programs, STEP, TestDomain};

use crate::frames::{median, sheet};

const HEADERS: [usize; 2] = [size_of::<StateHeader>(), size_of::<CorrectionHeader>()];

/// Round trip less compute, beside a Unix socket that copies the same bytes: lines of a Markdown table.
pub(crate) fn round_trips(programs: Programs, echo: fn(&str, usize) -> Command) -> Vec<String> {
    let domain = TestDomain::new();
    let _daemon = programs.start_daemon(&domain);
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
        let times: Vec<[f64; 4]> = (0..num_frames + 20)
            .map(|_| frame_times(&mut session, &mut socket, &positions))
            // The first frames build trees and touch memory.
            .skip(20)
            .collect();
        let [trip, compute, less, by_socket] =
            [0, 1, 2, 3].map(|k| median(times.iter().map(|times| times[k]).collect(), 0.5));
        lines
            .push(format!("| {n} | {trip:.0} | {compute:.0} | {less:.0} | {by_socket:.0} | {:.2} |", less / by_socket));
    }
    lines
}

/// Microseconds of a frame's round trip, of its computing, of the round trip without it, and of the same bytes through
/// a socket.
fn frame_times(session: &mut Session, socket: &mut Echo, positions: &[[f32; 3]]) -> [f64; 4] {
    let begin = Instant::now();
    let correction = session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(positions)).expect("an answer");
    // A host reads what it got.
    let sum: f32 = correction.vertices().iter().map(|vertex| vertex.value[0]).sum();
    let trip = std::hint::black_box((begin.elapsed(), sum)).0.as_secs_f64() * 1e6;
    let stages = &correction.header().stage_ns[stage::INTERSECT..=stage::RESPOND];
    let computing = stages.iter().sum::<u64>() as f64 / 1e3;
    drop(correction);
    let begin = Instant::now();
    socket.exchange(positions);
    [trip, computing, trip - computing, begin.elapsed().as_secs_f64() * 1e6]
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
pub(crate) fn echo_main(path: &str, num_vertices: usize) {
    let mut stream = UnixStream::connect(path).expect("the parent listens");
    let mut state = vec![0; HEADERS[0] + num_vertices * 12];
    let correction = vec![0; HEADERS[1] + num_vertices * size_of::<VertexCorrection>()];
    while stream.read_exact(&mut state).is_ok() && stream.write_all(&correction).is_ok() {}
}
