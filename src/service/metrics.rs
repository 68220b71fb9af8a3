//! Metrics of the daemon as Prometheus text over HTTP, on a thread of its own, one request at a time.
//!
//! The server reads the head of a request, answers, and closes the connection. A slow client is dropped after a second,
//! so that it does not keep others out for long. Frames never wait for this thread.

use std::{
    fmt::Write as _,
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use super::{
    error::ServeError,
    requests::{
        Registry,
        status::{self, Report, SessionReport},
    },
    throttle::Throttle,
};

/// Longest time for a request.
const PATIENCE: Duration = Duration::from_secs(1);
/// Longest head of a request in bytes.
const MAX_HEAD: usize = 4096;

/// A thread that answers until it is dropped.
#[derive(Debug)]
pub(crate) struct MetricsServer {
    address: SocketAddr,
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl MetricsServer {
    pub(crate) fn start(address: SocketAddr, registry: Arc<Registry>) -> Result<Self, ServeError> {
        let failed = |source| ServeError::System { what: "serving metrics", source };
        let listener = TcpListener::bind(address).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let ending = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&ending);
        let work = move || serve(&listener, &ends, &|| prometheus(&status::report(&registry)));
        let thread = std::thread::Builder::new().name("metrics".to_owned()).spawn(work).map_err(failed)?;
        tracing::info!(%address, "metrics at http://{address}/metrics");
        Ok(Self { address, ending, thread: Some(thread) })
    }
}

impl Drop for MetricsServer {
    fn drop(&mut self) {
        self.ending.store(true, Ordering::Release);
        // The thread waits for a connection; this one wakes it.
        let woken = TcpStream::connect_timeout(&self.address, PATIENCE);
        if woken.is_ok()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

fn serve(listener: &TcpListener, ending: &AtomicBool, body: &dyn Fn() -> String) {
    for stream in listener.incoming() {
        if ending.load(Ordering::Acquire) {
            return;
        }
        if let Err(error) = stream.and_then(|stream| answer(stream, body)) {
            static FAILED: Throttle = Throttle::new();
            if let Some(num_suppressed) = FAILED.admit() {
                tracing::info!(%error, num_suppressed, "a request for metrics failed");
            }
            // Without free descriptors `accept` fails at once; do not spin.
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

fn answer(mut stream: TcpStream, body: &dyn Fn() -> String) -> std::io::Result<()> {
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut buffer = [0; MAX_HEAD];
    let (status, text) = match read_path(&mut stream, &mut buffer)? {
        Some("/" | "/metrics") => ("200 OK", body()),
        Some(_) => ("404 Not Found", "metrics are at /metrics\n".to_owned()),
        None => ("400 Bad Request", "only GET is understood\n".to_owned()),
    };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\n\
         Content-Length: {}\r\nConnection: close\r\n\r\n",
        text.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(text.as_bytes())
}

/// The path of a GET request; nothing where it is none.
fn read_path<'a>(stream: &mut TcpStream, buffer: &'a mut [u8; MAX_HEAD]) -> std::io::Result<Option<&'a str>> {
    let end = Instant::now() + PATIENCE;
    let mut length = 0;
    loop {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        let read = stream.read(&mut buffer[length..])?;
        length += read;
        let mut headers = [httparse::EMPTY_HEADER; 32];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&buffer[..length]) {
            Ok(httparse::Status::Complete(_)) => break,
            Ok(httparse::Status::Partial) if read > 0 && length < MAX_HEAD => {}
            _ => return Ok(None),
        }
    }
    let mut headers = [httparse::EMPTY_HEADER; 32];
    let mut request = httparse::Request::new(&mut headers);
    let parsed = request.parse(&buffer[..length]);
    Ok(request.path.filter(|_| parsed.is_ok() && request.method == Some("GET")))
}

/// A number of a session.
type Value = fn(&SessionReport) -> f64;

#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
const BY_SESSION: &[(&str, &str, &str, Value)] = &[
    ("frames_total", "counter", "Frames that were answered.", |s| s.num_frames as f64),
    ("frames_refused_total", "counter", "Frames that could not be used.", |s| s.num_refused_frames as f64),
    ("frames_skipped_total", "counter", "Frames that were overtaken by newer ones.", |s| s.num_skipped_frames as f64),
    ("frames_truncated_total", "counter", "Frames that a limit ended, of time or of intersections.", |s| {
        s.num_truncated_frames as f64
    }),
    ("frame_rate_hz", "gauge", "Frames per second, lately.", |s| s.rate_hz),
    ("vertices", "gauge", "Vertices of the mesh.", |s| s.num_vertices as f64),
    ("faces", "gauge", "Faces of the mesh.", |s| s.num_faces as f64),
    ("edge_face_intersections", "gauge", "Edges that pierce a face, in the last frame.", |s| {
        s.num_edge_face_intersections as f64
    }),
    ("contour_length_metres", "gauge", "Length of all paths, in the last frame.", |s| s.contour_length_m),
];

/// The report in the text format of Prometheus, version 0.0.4.
#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
fn prometheus(report: &Report) -> String {
    let mut out = String::new();
    let mut family = |name: &str, kind: &str, help: &str, samples: &mut dyn FnMut(&mut String, &str)| {
        let name = format!("untangled_{name}");
        // Writing to a string does not fail.
        let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}");
        samples(&mut out, &name);
    };
    for (name, kind, help, value) in [
        ("uptime_seconds", "gauge", "Time since the daemon started.", report.uptime_s),
        ("workers", "gauge", "Threads that work on frames.", report.num_workers as f64),
        ("sessions", "gauge", "Sessions that are open.", report.sessions.len() as f64),
        ("sessions_registered_total", "counter", "Sessions that were registered.", report.num_registered as f64),
        ("requests_refused_total", "counter", "Requests that were refused.", report.num_refused_requests as f64),
    ] {
        family(name, kind, help, &mut |out, name| {
            let _ = writeln!(out, "{name} {value}");
        });
    }
    for (name, kind, help, value) in BY_SESSION {
        family(name, kind, help, &mut |out, name| {
            for session in &report.sessions {
                let _ = writeln!(out, "{name}{{session=\"{}\"}} {}", session.session, value(session));
            }
        });
    }
    family("stage_seconds_total", "counter", "Time spent in each stage of all frames.", &mut |out, name| {
        for session in &report.sessions {
            for (stage, seconds) in &session.stage_total_s {
                let _ = writeln!(out, "{name}{{session=\"{}\",stage=\"{stage}\"}} {seconds}", session.session);
            }
        }
    });
    out
}
