//! Time of a round trip through shared memory, beside a Unix socket.

use std::{
    io::{Read, Write},
    os::unix::net::{UnixListener, UnixStream},
    process::Command,
    time::Instant,
};

use untangled_client::{Registration, Session};
use untangled_proto::{CorrectionHeader, StateHeader, VertexCorrection, correction::stage};
use untangled_testkit::process::{PATIENCE, Programs, STEP, TestDomain};

use crate::frames::{median, sheet};

const HEADERS: [usize; 2] = [size_of::<StateHeader>(), size_of::<CorrectionHeader>()];

/// Round trip less compute of dense and of sparse corrections, beside a Unix socket that copies the bytes of dense
/// ones, all in turns: lines of a Markdown table.
pub(crate) fn round_trips(programs: Programs, echo: fn(&str, usize) -> Command) -> Vec<String> {
    let domain = TestDomain::new();
    let _daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let head = "| vertices | corrections | round trip us | of it compute us | round trip less compute us | Unix socket \
                us | ratio |";
    let mut lines = vec![head.to_owned(), "|---|---|---|---|---|---|---|".to_owned()];
    for num_vertices in [1_000, 16_000, 250_000] {
        let (registration, positions) = sheet(num_vertices);
        let n = positions.len();
        let mut sessions = [false, true].map(|sparse| {
            let session = client.register(Registration { sparse, ..registration.clone() }).expect("there is room");
            assert_eq!(session.is_sparse(), sparse);
            session
        });
        let mut socket = Echo::start(echo, n);
        let num_frames = if n > 100_000 { 60 } else { 400 };
        let times: Vec<([Trip; 2], f64)> = (0..num_frames + 20)
            .map(|_| (sessions.each_mut().map(|session| trip(session, &positions)), socket.exchange(&positions)))
            // The first frames build trees and touch memory.
            .skip(20)
            .collect();
        let socket_us = median(times.iter().map(|(_, socket_us)| *socket_us).collect(), 0.5);
        for (which, name) in ["dense", "sparse"].into_iter().enumerate() {
            let middle =
                |part: fn(&Trip) -> f64| median(times.iter().map(|(trips, _)| part(&trips[which])).collect(), 0.5);
            let [whole, compute] = [middle(|trip| trip.whole_us), middle(|trip| trip.compute_us)];
            let less = middle(|trip| trip.whole_us - trip.compute_us);
            let ratio = less / socket_us;
            lines.push(format!(
                "| {n} | {name} | {whole:.0} | {compute:.0} | {less:.0} | {socket_us:.0} | {ratio:.2} |"
            ));
        }
    }
    lines
}

/// Microseconds of a frame's round trip, and of its computing.
struct Trip {
    whole_us: f64,
    compute_us: f64,
}

fn trip(session: &mut Session, positions: &[[f32; 3]]) -> Trip {
    let begin = Instant::now();
    let correction = session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(positions)).expect("an answer");
    // A host reads what it got.
    let sum: f32 = match correction.sparse() {
        Some(entries) => entries.iter().map(|entry| entry.value[0]).sum(),
        None => correction.vertices().iter().map(|vertex| vertex.value[0]).sum(),
    };
    let whole_us = std::hint::black_box((begin.elapsed(), sum)).0.as_secs_f64() * 1e6;
    let stages = &correction.header().stage_ns[stage::INTERSECT..=stage::RESPOND];
    Trip { whole_us, compute_us: stages.iter().sum::<u64>() as f64 / 1e3 }
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

    /// Microseconds of a state and its answer.
    fn exchange(&mut self, positions: &[[f32; 3]]) -> f64 {
        let begin = Instant::now();
        self.out.truncate(HEADERS[0]);
        self.out.extend(positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        self.stream.write_all(&self.out).expect("the child reads");
        self.stream.read_exact(&mut self.answer).expect("the child answers");
        std::hint::black_box(&self.answer);
        begin.elapsed().as_secs_f64() * 1e6
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
