//! Daemons and clients as processes that can be killed, on a domain of their own.

use std::{
    io::{BufRead, BufReader, Read, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, ExitStatus, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};
use untangled_client::{Client, ClientOptions, RegisterError, RequestError, Session, Status};
use untangled_transport::{Domain, lock::DomainLock, memory};

use super::scene::Scene;

/// Far beyond what anything takes here; only a failure waits this long.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// How to start the processes; tests and the command do it differently.
#[derive(Clone, Copy)]
pub struct Programs {
    /// `serve` on a domain, with these arguments besides.
    pub daemon: fn(&str, &[&str]) -> Command,
    /// [`client_main`] with a domain and a role.
    pub client: fn(&str, &str) -> Command,
}

/// A domain of one trial's own. When it goes, so does what is left of it.
pub struct TestDomain(pub Domain);

impl TestDomain {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("soak-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        Self(Domain::locate(Some(&name)).expect("the name is short"))
    }

    pub fn name(&self) -> &str {
        self.0.name()
    }

    pub fn connect(&self) -> Client {
        Client::connect(ClientOptions { domain: Some(self.name().to_owned()), timeout: PATIENCE })
            .expect("a daemon runs")
    }

    /// Number and bytes of the domain's files in shared memory.
    pub fn shared_memory(&self) -> (usize, u64) {
        use std::os::unix::fs::MetadataExt;
        let entries = std::fs::read_dir(memory::FOLDER).expect("there is shared memory").flatten();
        let ours = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(self.0.prefix()));
        // What goes meanwhile is not there.
        ours.filter_map(|entry| entry.metadata().ok())
            .fold((0, 0), |(n, bytes), file| (n + 1, bytes + 512 * file.blocks()))
    }

    /// Number of files below the domain's root.
    pub fn num_files(&self) -> usize {
        fn count(folder: &Path) -> usize {
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
            entries.map(|entry| if entry.path().is_dir() { count(&entry.path()) } else { 1 }).sum()
        }
        count(self.0.root())
    }
}

impl Drop for TestDomain {
    fn drop(&mut self) {
        let _ = DomainLock::acquire(&self.0).and_then(|lock| lock.wipe_if_unused());
        let _ = std::fs::remove_file(self.0.lock_path());
    }
}

/// A daemon that has said `ready`.
pub struct Daemon(Child);

impl Daemon {
    pub fn start(programs: Programs, domain: &TestDomain, arguments: &[&str]) -> Self {
        let mut command = (programs.daemon)(domain.name(), arguments);
        let mut child = command.stderr(Stdio::piped()).spawn().expect("the daemon's program is there");
        let mut lines = BufReader::new(child.stderr.take().expect("it is a pipe")).lines();
        let mut said = Vec::new();
        let ready =
            lines.by_ref().map_while(Result::ok).inspect(|line| said.push(line.clone())).any(|line| line == "ready");
        assert!(ready, "the daemon did not start: {said:?}");
        // Read on, so that the daemon never blocks on its log, and show what matters, or all of it.
        let all = std::env::var_os("SOAK_LOG").is_some();
        std::thread::spawn(move || {
            let shown = lines.map_while(Result::ok).filter(|line| all || line.contains("panicked"));
            shown.for_each(|line| eprintln!("{line}"));
        });
        Self(child)
    }

    pub fn pid(&self) -> u32 {
        self.0.id()
    }

    pub fn is_running(&mut self) -> bool {
        self.0.try_wait().is_ok_and(|status| status.is_none())
    }

    pub fn stop(mut self, signal: Signal) -> ExitStatus {
        send_signal(&self.0, signal);
        self.0.wait().expect("it was started here")
    }

    /// Resident memory in bytes: without the shared memory that it has mapped.
    pub fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.pid())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:")).unwrap_or("0 kB");
        1024 * line.trim().trim_end_matches(" kB").parse::<u64>().unwrap_or(0)
    }

    /// CPU time so far in ticks of 10 ms.
    pub fn ticks(&self) -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.pid())).unwrap_or_default();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
        [11, 12].iter().filter_map(|&k| fields.get(k)?.parse::<u64>().ok()).sum()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A client process; it says on standard output how far it is.
pub struct ClientProcess {
    child: Child,
    output: BufReader<ChildStdout>,
}

impl ClientProcess {
    pub fn start(programs: Programs, domain: &TestDomain, role: &str) -> Self {
        let mut command = (programs.client)(domain.name(), role);
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the client's program is there");
        let output = BufReader::new(child.stdout.take().expect("it is a pipe"));
        Self { child, output }
    }

    pub fn signal(&self, signal: Signal) {
        send_signal(&self.child, signal);
    }

    /// Waits until it has said something.
    pub fn wait_for(&mut self, what: &str) {
        let said = self.output.by_ref().lines().map_while(Result::ok).any(|line| line.contains(what));
        assert!(said, "the client ended before it said `{what}`");
    }

    /// Kills it; returns the last thing that it said.
    pub fn kill(mut self) -> String {
        self.signal(Signal::KILL);
        let last = self.output.by_ref().lines().map_while(Result::ok).filter(|line| line.starts_with("at ")).last();
        self.child.wait().expect("it was started here");
        last.unwrap_or_else(|| "at start".to_owned())
    }
}

impl Drop for ClientProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn send_signal(child: &Child, signal: Signal) {
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw).expect("a process has an id");
    kill_process(pid, signal).expect("it was not waited for yet");
}

/// Waits for something that another process does.
pub fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < end, "never: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The client process. `frames` exchanges frames and keeps corrections, `loan` stops with a loan in its hands, `register` registers a
/// large mesh over and over.
pub fn client_main(domain: &str, role: &str) {
    let say = |what: &str| {
        println!("at {what}");
        let _ = std::io::stdout().flush();
    };
    // Long enough that it outlives a daemon that is restarted, and not much longer than whoever watches it.
    let options = ClientOptions { domain: Some(domain.to_owned()), timeout: PATIENCE };
    let client = match Client::connect(options) {
        Ok(client) => client,
        Err(error) => return eprintln!("a client that connected: {error}"),
    };
    say("connected");
    let scene = Scene::new(if role == "register" { 20_000 } else { 500 });
    let mut held = std::collections::VecDeque::new();
    loop {
        say("registering");
        let mut session = match client.register(scene.registration()) {
            Ok(session) => session,
            // The sessions of the dead count until they are cleaned up behind.
            Err(RegisterError::Request(RequestError::Refused { status: Status::TooManySessions, .. })) => {
                std::thread::sleep(Duration::from_millis(20));
                continue;
            }
            Err(error) => return eprintln!("a client that registered: {error}"),
        };
        say("registered");
        if role == "register" {
            continue;
        }
        loop {
            match scene.exchange(&mut session, Duration::from_millis(500)) {
                Ok(correction) if scene.is_right(&correction) => held.push_back(correction),
                Ok(correction) => say(&format!("wrong frame {}", correction.frame())),
                // A daemon that went away comes back.
                Err(_) => {}
            }
            if held.len() > 2 {
                held.pop_front();
            }
            say("frame");
            if role == "loan" && session.frame() > 3 {
                hold_loan(&mut session, &say);
            }
        }
    }
}

fn hold_loan(session: &mut Session, say: &dyn Fn(&str)) {
    let _ = session.publish(super::scene::STEP, |_| {
        say("loan");
        std::thread::sleep(PATIENCE);
    });
}

/// The program that runs now, in another role.
pub fn this_program() -> PathBuf {
    std::env::current_exe().expect("the system knows this program")
}
