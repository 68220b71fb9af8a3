//! A real daemon process on a private domain, and meshes to send it.

#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::{
    io::{BufRead, BufReader},
    path::PathBuf,
    process::{Child, Command, ExitStatus, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    time::{Duration, Instant},
};

use iceoryx2::prelude::{EventId, LogLevel, Node, NodeBuilder, SignalHandlingMode, set_log_level};
use rustix::process::{Pid, Signal, kill_process};
use untangled_client::{Client, ClientOptions, Registration, StepTime};
use untangled_transport::{Domain, services::{self, Ipc}};
use untangled_proto::{PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, names};

/// Far beyond what anything takes here; only a failure waits this long.
pub const DEADLINE: Duration = Duration::from_secs(60);
pub const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 0.01 };

/// A domain of one test's own. When it goes, so does what is left of it.
pub struct TestDomain(pub Domain);

impl TestDomain {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("test-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        Self(Domain::locate(Some(&name)).unwrap())
    }

    pub fn name(&self) -> &str {
        self.0.name()
    }

    pub fn connect(&self) -> Client {
        Client::connect(self.options()).unwrap()
    }

    pub fn options(&self) -> ClientOptions {
        ClientOptions { domain: Some(self.name().to_owned()), timeout: DEADLINE }
    }

    /// Files of the domain in shared memory.
    pub fn shared_memory(&self) -> Vec<String> {
        let names = std::fs::read_dir("/dev/shm").unwrap().map(|entry| entry.unwrap().file_name());
        names.filter_map(|name| name.into_string().ok()).filter(|name| name.starts_with(self.0.prefix())).collect()
    }

    /// Bytes of shared memory that the domain has taken.
    pub fn shared_bytes(&self) -> u64 {
        use std::os::unix::fs::MetadataExt;
        let files = self.shared_memory().into_iter().map(|name| PathBuf::from("/dev/shm").join(name));
        files.filter_map(|path| std::fs::metadata(path).ok()).map(|file| 512 * file.blocks()).sum()
    }

    /// Everything but folders below the domain's root.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut folders = vec![self.0.root().to_owned()];
        let mut files = Vec::new();
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                    folders.push(entry.path());
                } else {
                    files.push(entry.path());
                }
            }
        }
        files
    }

    pub fn assert_nothing_left(&self) {
        assert_eq!(self.shared_memory(), Vec::<String>::new());
        assert_eq!(self.files(), Vec::<PathBuf>::new());
    }
}

impl Drop for TestDomain {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(self.0.root());
        let _ = std::fs::remove_file(self.0.lock_path());
        for name in self.shared_memory() {
            let _ = std::fs::remove_file(PathBuf::from("/dev/shm").join(name));
        }
    }
}

/// A daemon process that has said `ready`.
pub struct Daemon(Child);

impl Daemon {
    pub fn start(domain: &TestDomain) -> Self {
        let mut child = command(domain).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        assert!(lines.any(|line| line.unwrap() == "ready"), "the daemon did not start");
        // Read on, so that the daemon never blocks on its log, and show it where a test fails.
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| eprintln!("{line}")));
        Self(child)
    }

    pub fn pid(&self) -> u32 {
        self.0.id()
    }

    pub fn signal(&self, signal: Signal) {
        kill_process(pid(&self.0), signal).unwrap();
    }

    pub fn stop(mut self, signal: Signal) -> ExitStatus {
        self.signal(signal);
        self.0.wait().unwrap()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub fn pid(child: &Child) -> Pid {
    Pid::from_raw(i32::try_from(child.id()).unwrap()).unwrap()
}

pub fn command(domain: &TestDomain) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_untangled"));
    command.args(["serve", "--domain", domain.name()]);
    command
}

/// Waits for something that another process does.
pub fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + DEADLINE;
    while !holds() {
        assert!(Instant::now() < end, "never: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A flat sheet of `n x n` squares with masses.
pub fn sheet(n: u32) -> Registration {
    let side = n + 1;
    let corner = |i: u32, j: u32| i * side + j;
    let square = |i, j| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let num_vertices = (side * side) as usize;
    Registration {
        num_vertices,
        triangles: (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect(),
        masses_kg: Some(vec![0.01; num_vertices]),
        ..Registration::default()
    }
}

/// Positions of a flat sheet of `num_vertices = (n + 1)^2`.
pub fn fill_flat<T: From<f32> + Copy>(positions: &mut [[T; 3]]) {
    let side = positions.len().isqrt();
    for (k, position) in positions.iter_mut().enumerate() {
        let coordinate = |k: usize| T::from(u16::try_from(k).map(f32::from).unwrap() * 0.01);
        *position = [coordinate(k / side), coordinate(k % side), T::from(0.0)];
    }
}

/// A raw iceoryx2 node of the domain, for clients that don't keep to the rules.
pub fn node(domain: &TestDomain) -> Node<Ipc> {
    set_log_level(LogLevel::Fatal);
    NodeBuilder::new()
        .config(&domain.0.config().unwrap())
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create()
        .unwrap()
}

/// Sends a raw request and waits for its reply.
pub fn request(domain: &TestDomain, header: RequestHeader, payload: &[u8]) -> (ReplyHeader, String) {
    let node = node(domain);
    let control = services::open_control(&node).unwrap();
    let port = control.client_builder().initial_max_slice_len(payload.len().max(1)).create().unwrap();
    let mut request = port.loan_slice_uninit(payload.len()).unwrap();
    *request.user_header_mut() = header;
    let pending = request.write_from_slice(payload).send().unwrap();
    let event = services::open_event(&node, names::CONTROL).unwrap();
    event.notifier_builder().create().unwrap().notify_with_custom_event_id(EventId::new(names::EVENT_REQUEST)).unwrap();
    let mut reply = None;
    eventually("a reply", || {
        reply = pending.receive().unwrap();
        reply.is_some()
    });
    let reply = reply.unwrap();
    (*reply.user_header(), String::from_utf8(reply.payload().to_vec()).unwrap())
}

/// The name of a session's service in this run of the daemon.
pub fn session_service_name(domain: &TestDomain, session: u64, service: names::SessionService) -> String {
    let header = RequestHeader {
        protocol_version: PROTOCOL_VERSION,
        kind: RequestKind::Hello as u32,
        ..RequestHeader::default()
    };
    names::session(request(domain, header, &[]).0.instance, session, service)
}
