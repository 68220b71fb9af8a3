//! The counts over HTTP on a loopback address: `/metrics` as Prometheus text, `/status` as JSON.

use std::{
    fmt::Write as _,
    io::{self, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use serde_json::Value;

use super::counts::Metrics;
use crate::error::BridgeError;

/// Longest time for one connection, and longest head of a request in bytes.
const PATIENCE: Duration = Duration::from_millis(500);
const MAX_HEAD_BYTES: usize = 4096;
/// How often the thread looks for connections, and whether it is to end.
const PERIOD: Duration = Duration::from_millis(50);

/// Makes the report of an end; nothing where the end is gone.
pub trait Report: Fn() -> Option<Value> + Send + 'static {}

impl<F: Fn() -> Option<Value> + Send + 'static> Report for F {}

/// The thread that serves; it ends when this is dropped. One connection at a time, each for half a second at most:
/// frames never wait for it.
#[derive(Debug)]
pub struct Server {
    stop: Arc<AtomicBool>,
    /// Where it listens.
    pub address: SocketAddr,
}

impl Server {
    /// Starts it.
    ///
    /// # Errors
    /// [`BridgeError::System`]: the address can't be listened on.
    pub fn start(address: SocketAddr, metrics: Arc<Metrics>, report: impl Report) -> Result<Self, BridgeError> {
        let failed = |source| BridgeError::System { what: format!("serving metrics on {address}"), source };
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let serve = move || {
            while !stopped.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((stream, _)) => {
                        if let Err(error) = answer(stream, &metrics, &report) {
                            tracing::debug!(%error, "a reader of metrics");
                        }
                    }
                    Err(_) => std::thread::sleep(PERIOD),
                }
            }
        };
        std::thread::Builder::new().name("metrics".into()).spawn(serve).map_err(failed)?;
        Ok(Self { stop, address })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

fn answer(mut stream: TcpStream, metrics: &Metrics, report: &impl Report) -> io::Result<()> {
    let begin = Instant::now();
    stream.set_nonblocking(false)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut head = Vec::new();
    while !head.windows(4).any(|end| end == b"\r\n\r\n") && head.len() < MAX_HEAD_BYTES {
        let left = PATIENCE.saturating_sub(begin.elapsed());
        if left.is_zero() {
            return Ok(());
        }
        stream.set_read_timeout(Some(left))?;
        let mut bytes = [0; 512];
        match stream.read(&mut bytes)? {
            0 => return Ok(()),
            count => head.extend_from_slice(&bytes[..count]),
        }
    }
    let path = head.split(|byte| *byte == b' ').nth(1).unwrap_or_default();
    let (status, kind, body) = match path {
        b"/metrics" => ("200 OK", "text/plain; version=0.0.4", text(metrics)),
        b"/status" => match report() {
            Some(report) => ("200 OK", "application/json", report.to_string()),
            None => ("503 Service Unavailable", "text/plain", "ending\n".to_owned()),
        },
        _ => ("404 Not Found", "text/plain", "there are /metrics and /status\n".to_owned()),
    };
    let length = body.len();
    let head =
        format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())
}

/// Prometheus text.
fn text(metrics: &Metrics) -> String {
    let mut out = String::new();
    let report = metrics.report();
    let counters = [
        ("sent_messages", "num_sent", "Messages with a frame that left"),
        ("sent_bytes", "bytes_sent", "Bytes of these"),
        ("received_messages", "num_received", "Messages with a frame that came"),
        ("received_bytes", "bytes_received", "Bytes of these"),
        ("repeated_messages", "num_sent_again", "Messages that were sent again after a connection broke"),
        ("overtaken_frames", "num_overtaken", "Frames that a newer one overtook before they left"),
        ("rejected_messages", "num_rejected", "Messages that were dropped: wrong session or frame, twice, malformed"),
        ("requests", "num_requests", "Requests that were passed on"),
        ("refused_requests", "num_refused_requests", "Requests that this end refused"),
        ("lost_sessions", "num_lost_sessions", "Sessions that ended because a daemon or an end went away"),
    ];
    // Writing to a string does not fail.
    for (name, key, help) in counters {
        let name = format!("untangled_bridge_{name}_total");
        let _ = writeln!(out, "# HELP {name} {help}.\n# TYPE {name} counter\n{name} {}", report[key]);
    }
    let name = "untangled_bridge_round_trip_seconds";
    let _ = writeln!(out, "# HELP {name} From a message's leaving to its acknowledgement.\n# TYPE {name} histogram");
    let (ends, count, sum_s) = metrics.round_trips.cumulative();
    for (end, up_to) in ends {
        let _ = writeln!(out, "{name}_bucket{{le=\"{end}\"}} {up_to}");
    }
    let _ = writeln!(out, "{name}_bucket{{le=\"+Inf\"}} {count}\n{name}_sum {sum_s}\n{name}_count {count}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(address: SocketAddr, path: &str) -> String {
        let mut stream = TcpStream::connect(address).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        reply
    }

    #[test]
    fn server_answers_metrics_and_status_and_drops_readers_that_say_nothing() {
        let metrics = Arc::new(Metrics::default());
        metrics.sent.add(100);
        metrics.round_trips.add(Duration::from_micros(100));
        let report = || Some(serde_json::json!({ "end": "host" }));
        let server = Server::start("127.0.0.1:0".parse().unwrap(), metrics, report).unwrap();
        let silent = TcpStream::connect(server.address).unwrap();
        let text = get(server.address, "/metrics");
        assert!(text.contains("untangled_bridge_sent_bytes_total 100\n"), "{text}");
        assert!(text.contains("round_trip_seconds_bucket{le=\"0.000128\"} 1\n"), "{text}");
        assert!(get(server.address, "/status").ends_with("{\"end\":\"host\"}"));
        assert!(get(server.address, "/other").starts_with("HTTP/1.1 404"));
        drop(silent);
    }
}
