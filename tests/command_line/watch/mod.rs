//! `untangled watch`: what it prints, how it ends, and its page in a browser with a daemon and hosts.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    process::{Child, Command, Stdio},
};

use rustix::process::Signal;
use serde_json::Value;
use untangle::{
    frame::Frame,
    mesh::Mesh,
    sides::{Layers, Sides},
};
use untangled_client::Registration;
use untangled_testkit::{
    generate::outfits::{Outfit, Pose},
    process::{Daemon, PATIENCE, STEP, TestDomain, send_signal, untangled},
};

use crate::html::browser::drive_by;

/// A server, and the address that it has printed.
struct Watch {
    child: Child,
    /// `127.0.0.1:PORT`, and `/TOKEN/`.
    address: (String, String),
}

impl Watch {
    fn start(domain: &TestDomain) -> Self {
        let mut command = Command::new(untangled());
        command.args(["watch", "--domain", domain.name()]).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let (host, path) = line.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        Self { child, address: (host.to_owned(), format!("/{path}")) }
    }

    /// The head and the body of an answer.
    fn get(&self, what: &str) -> String {
        let (host, path) = &self.address;
        let mut stream = TcpStream::connect(host).unwrap();
        // A wrong origin would be refused; the length says where the answer ends, and the half that is closed that no
        // other question comes.
        write!(stream, "GET {path}{what} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n\r\n").unwrap();
        stream.shutdown(std::net::Shutdown::Write).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn address_is_on_loopback_with_a_token_and_the_end_is_clean() {
    let domain = TestDomain::new();
    for signal in [Signal::INT, Signal::TERM] {
        let mut watch = Watch::start(&domain);
        assert!(watch.address.0.starts_with("127.0.0.1:"), "{}", watch.address.0);
        assert_eq!(watch.address.1.trim_matches('/').len(), 32, "{}", watch.address.1);
        let sessions = watch.get("sessions");
        assert!(sessions.starts_with("HTTP/1.1 200") && sessions.contains(domain.name()), "{sessions}");
        send_signal(&watch.child, signal);
        assert_eq!(watch.child.wait().unwrap().code(), Some(0));
    }
    domain.assert_nothing_left();
}

#[test]
fn sessions_of_a_daemon_are_listed_and_one_that_is_watched_leaves_nothing_behind() {
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let mut watch = Watch::start(&domain);
    assert!(watch.get("sessions").contains("\"sessions\":[],"));
    let mut publish = Command::new(untangled());
    publish.args(["publish", "--domain", domain.name(), "--scene", "crease", "--edge-m", "0.06", "--no-corrections"]);
    publish.args(["--frames", "1000000", "--clean-frames", "0", "--report-every", "0"]).stdout(Stdio::null());
    let mut host = publish.spawn().unwrap();
    let name = loop {
        let sessions = watch.get("sessions");
        if let Some((_, rest)) = sessions.split_once("\"session\":\"") {
            break rest.split('"').next().unwrap().to_owned();
        }
    };
    assert!(watch.get(&format!("mesh?session={name}")).contains("\"num_vertices\":"));
    let frame = watch.get(&format!("frame?session={name}&after=0"));
    assert!(frame.contains("Untangled-Serial: ") && frame.contains("\"LL\""), "{}", &frame[..600.min(frame.len())]);
    let status = domain.connect().status().unwrap();
    assert_eq!(status["sessions"][0]["observers"][0]["name"], "untangled watch", "{status}");
    send_signal(&watch.child, Signal::INT);
    assert_eq!(watch.child.wait().unwrap().code(), Some(0));
    host.kill().unwrap();
    host.wait().unwrap();
    drop(watch);
    assert_eq!(daemon.stop(Signal::TERM).code(), Some(0));
}

#[test]
fn cloth_on_the_wrong_side_of_bodies_and_layers_is_told_with_the_frame() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let watch = Watch::start(&domain);
    let (description, positions) = Outfit::new(Pose::ALL[0], 20).world();
    #[expect(clippy::cast_possible_truncation, reason = "the wire carries single precision")]
    let single: Vec<[f32; 3]> = positions.iter().map(|place| place.map(|x| x as f32)).collect();
    let rounded: Vec<[f64; 3]> = single.iter().map(|place| place.map(f64::from)).collect();
    let registration = Registration {
        num_vertices: description.num_vertices,
        triangles: description.faces.clone(),
        layers: description.layers.clone(),
        body: description.body.clone(),
        rest_positions: Some(rounded.clone()),
        ..Registration::default()
    };
    let mut session = domain.connect().register(registration).unwrap();
    let listed = watch.get("sessions");
    let name = listed.split("\"session\":\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
    // From now on there is an observer, which sees the frames after it.
    let answer = std::thread::scope(|scope| {
        let asked = scope.spawn(|| {
            loop {
                let frame = watch.get(&format!("frame?session={name}&after=0"));
                if frame.contains("Untangled-Serial: ") {
                    break frame;
                }
            }
        });
        while !asked.is_finished() {
            session.exchange(STEP, PATIENCE, |out| out.copy_from_slice(&single)).unwrap();
        }
        asked.join().unwrap()
    });
    let text = &answer[answer.find('{').unwrap()..];
    let header: Value = serde_json::Deserializer::from_str(text).into_iter().next().unwrap().unwrap();
    let mesh = Mesh::new(description).unwrap();
    let frame = Frame::new(&mesh, &rounded).unwrap();
    let sides = Sides::of(&mesh, &frame).unwrap();
    let behind = Layers::of(&mesh, &frame, Some(&sides)).unwrap().behind(&mesh, frame.positions());
    let inside = sides.wrong_vertices(&mesh, &frame);
    assert!(behind.len() > 20, "there is something to tell");
    for (kind, wrong) in [("body", inside), ("layer", behind)] {
        let depth_m = wrong.iter().map(|wrong| wrong.way.depth_m).fold(0.0, f64::max);
        let told = header["wrong"].as_array().unwrap().iter().find(|told| told["kind"] == kind).unwrap();
        assert_eq!(told["num_vertices"], wrong.len(), "{kind}");
        assert!((told["depth_m"].as_f64().unwrap() - depth_m).abs() < 1e-12, "{told}, and not {depth_m}");
    }
}

#[test]
fn port_that_is_taken_is_an_error_of_one_line() {
    let domain = TestDomain::new();
    let watch = Watch::start(&domain);
    let port = watch.address.0.split(':').next_back().unwrap().to_owned();
    let output =
        Command::new(untangled()).args(["watch", "--domain", domain.name(), "--port", &port]).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains(&format!("--port {port}")) && error.lines().count() == 1, "{error}");
}

#[test]
fn page_of_live_sessions_works_in_a_browser() {
    let domain = TestDomain::new();
    let program = untangled();
    let arguments = ["drive/watch.mjs", program.to_str().unwrap(), domain.name()];
    let Some(seen) = drive_by("live sessions in a browser", &arguments) else { return };
    assert!(seen["pixels"].as_object().unwrap().len() > 4, "{seen}");
}
