//! Watching a daemon: status, metrics, logs, and what systemd hears.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    os::unix::net::UnixDatagram,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use rustix::process::Signal;
use serde_json::Value;
use untangled_client::StepTime;
use untangled_proto::Status;
use untangled_testkit::process::{
    Daemon, PATIENCE, RawPeer, STEP, TestDomain, eventually, fill_flat, header, send_signal, serve, sheet, untangled,
};

/// A daemon whose log is kept.
struct Logging {
    child: Child,
    lines: Box<dyn Iterator<Item = String> + Send>,
}

impl Logging {
    fn start(mut command: Command) -> Self {
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        Self { child, lines: Box::new(lines.map_while(Result::ok)) }
    }

    fn wait_for(&mut self, what: &str) -> String {
        let found = self.lines.by_ref().find(|line| line.contains(what));
        found.unwrap_or_else(|| panic!("the daemon ended without `{what}`"))
    }

    /// Ends the daemon and returns the rest of its log.
    fn stop(mut self) -> Vec<String> {
        send_signal(&self.child, Signal::TERM);
        let rest = self.lines.by_ref().collect();
        assert!(self.child.wait().unwrap().success());
        rest
    }
}

impl Drop for Logging {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn http(address: &str, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn metrics_of_a_session_are_prometheus_text() {
    let domain = TestDomain::new();
    let mut serve = serve(&domain);
    serve.args(["--metrics", "127.0.0.1:0"]);
    let mut daemon = Logging::start(serve);
    let line = daemon.wait_for("metrics at http://");
    let address = line.split("http://").nth(1).unwrap().split('/').next().unwrap().to_owned();
    daemon.wait_for("ready");
    let mut session = domain.connect().register(sheet(4)).unwrap();
    (0..3).for_each(|_| drop(session.exchange(STEP, PATIENCE, fill_flat).unwrap()));
    session.exchange(StepTime { dt_s: -1.0, ..STEP }, PATIENCE, fill_flat).unwrap_err();
    let answer = http(&address, "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200") && head.contains("version=0.0.4"), "{head}");
    for line in [
        "untangled_sessions 1",
        "untangled_sessions_registered_total 1",
        "untangled_frames_total{session=\"1\"} 4",
        "untangled_frames_refused_total{session=\"1\"} 1",
        "untangled_vertices{session=\"1\"} 25",
        "untangled_daemon_repairs_total 0",
        "# TYPE untangled_repairs_total counter",
        "# TYPE untangled_stage_seconds_total counter",
    ] {
        assert!(body.lines().any(|other| other == line), "{line} is missing in\n{body}");
    }
    // Each line is a comment, or a name, maybe labels, and a number.
    for line in body.lines().filter(|line| !line.starts_with('#')) {
        assert!(line.rsplit(' ').next().unwrap().parse::<f64>().is_ok(), "{line}");
    }
    assert!(http(&address, "GET /other HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404"));
    assert!(http(&address, "POST /metrics HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 405"));
    let head = http(&address, "HEAD /metrics HTTP/1.1\r\n\r\n");
    assert!(head.starts_with("HTTP/1.1 200") && head.ends_with("\r\n\r\n"), "{head}");
    assert!(http(&address, "nonsense\r\n\r\n").starts_with("HTTP/1.1 400"));
    // Silent connections keep no other waiting, and no frame. More than are served at a time take the places of the
    // oldest.
    let _silent: Vec<_> = (0..100).map(|_| TcpStream::connect(&address).unwrap()).collect();
    let begin = Instant::now();
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    assert!(http(&address, "GET / HTTP/1.0\r\n\r\n").starts_with("HTTP/1.1 200"));
    assert!(begin.elapsed() < Duration::from_millis(900), "{:?}", begin.elapsed());
    // The session ends; what was counted stays.
    drop(session);
    eventually("the session has ended", || http(&address, "GET / HTTP/1.0\r\n\r\n").contains("untangled_sessions 0\n"));
    let after = http(&address, "GET / HTTP/1.0\r\n\r\n");
    assert!(after.contains("untangled_daemon_frames_total 5\n"), "{after}");
    assert!(after.contains("untangled_daemon_frames_refused_total 1\n"), "{after}");
    daemon.stop();
}

#[test]
fn metrics_on_a_public_address_are_refused() {
    let domain = TestDomain::new();
    let output = serve(&domain).args(["--metrics", "0.0.0.0:0"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("0.0.0.0:0"));
}

#[test]
fn status_watch_repeats_until_the_daemon_ends() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let mut watching = Command::new(untangled())
        .args(["status", "--domain", domain.name(), "--json", "--watch", "0.1"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(watching.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut frames = || {
        let report: Value = serde_json::from_str(&lines.next().unwrap()).unwrap();
        assert_eq!(report["schema"], "untangled.status/1");
        report["num_frames"].as_u64().unwrap()
    };
    assert_eq!(frames(), 0);
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    while frames() == 0 {}
    let before = frames();
    drop(session);
    // What was counted stays when its session ends.
    (0..8).for_each(|_| assert!(frames() >= before));
    assert!(daemon.stop(Signal::TERM).success());
    while lines.next().is_some() {}
    assert_eq!(watching.wait().unwrap().code(), Some(2), "the daemon is gone, and that is said");
    let table = Command::new(untangled()).args(["status", "--watch", "0"]).output().unwrap();
    assert_eq!(table.status.code(), Some(2));
}

#[test]
fn daemon_under_systemd_notifies_ready_and_stopping() {
    let domain = TestDomain::new();
    let path = std::env::temp_dir().join(format!("{}.notify", domain.name()));
    let socket = UnixDatagram::bind(&path).unwrap();
    socket.set_read_timeout(Some(PATIENCE)).unwrap();
    let mut serve = serve(&domain);
    serve.env("NOTIFY_SOCKET", &path);
    let daemon = Logging::start(serve);
    let receive = || {
        let mut buffer = [0; 256];
        let length = socket.recv(&mut buffer).unwrap();
        String::from_utf8(buffer[..length].to_vec()).unwrap()
    };
    assert!(receive().contains("READY=1"));
    domain.connect().register(sheet(2)).unwrap();
    daemon.stop();
    assert!(receive().contains("STOPPING=1"));
    std::fs::remove_file(path).unwrap();
}

#[test]
fn log_of_many_refusals_is_json_and_limited() {
    let domain = TestDomain::new();
    let mut serve = serve(&domain);
    serve.env("UNTANGLED_TELEMETRY__FORMAT", "json");
    let mut daemon = Logging::start(serve);
    daemon.wait_for("ready");
    let mut session = domain.connect().register(sheet(2)).unwrap();
    for _ in 0..500 {
        session.exchange(StepTime { dt_s: f64::NAN, ..STEP }, PATIENCE, fill_flat).unwrap_err();
    }
    let peer = RawPeer::new(&domain);
    for _ in 0..50 {
        assert_eq!(peer.expect_reply(header(77, 0), &[]).0.status, Status::BadRequest.code());
    }
    drop(peer);
    drop(session);
    let lines: Vec<Value> = daemon.stop().iter().map(|line| serde_json::from_str(line).unwrap()).collect();
    let count = |message: &str| lines.iter().filter(|line| line["fields"]["message"] == message).count();
    // Ten at once and one a second after that; this takes seconds at most.
    assert!((1..100).contains(&count("frame refused")), "{}", count("frame refused"));
    assert!((1..50).contains(&count("request refused")), "{}", count("request refused"));
    assert!(lines.iter().any(|line| line["fields"]["num_suppressed"].is_u64()));
}
