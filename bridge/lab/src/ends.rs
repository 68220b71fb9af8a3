//! Daemons and ends of a bridge as processes.

use std::{
    env, fs,
    io::{BufRead, BufReader},
    net::{SocketAddr, TcpListener},
    path::PathBuf,
    process::{Child, Command, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    time::{Duration, Instant},
};

use untangled_client::{Client, ClientOptions};
use untangled_transport::{Domain, memory};

/// Longest wait for something that has to happen; a busy machine is slow.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// A domain that no other test uses. Dropping it removes its files.
#[derive(Debug)]
pub struct TestDomain(pub Domain);

impl Default for TestDomain {
    fn default() -> Self {
        Self::new()
    }
}

impl TestDomain {
    /// Chooses a name that nobody else has; makes no file.
    #[must_use]
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("br-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        Self(Domain::locate(Some(&name)).unwrap())
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.0.name()
    }

    /// A client in it.
    #[must_use]
    pub fn connect(&self) -> Client {
        Client::connect(ClientOptions { domain: Some(self.name().to_owned()), timeout: PATIENCE }).unwrap()
    }

    /// Names of the domain's files in shared memory.
    #[must_use]
    pub fn shared_memory(&self) -> Vec<String> {
        let names =
            fs::read_dir(memory::FOLDER).unwrap().flatten().filter_map(|entry| entry.file_name().into_string().ok());
        names.filter(|name| name.starts_with(self.0.prefix())).collect()
    }
}

impl Drop for TestDomain {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(self.0.root());
        let _ = fs::remove_file(self.0.lock_path());
        for name in self.shared_memory() {
            let _ = fs::remove_file(PathBuf::from(memory::FOLDER).join(name));
        }
    }
}

/// A process that has said `ready` on standard error. Dropping it kills it.
#[derive(Debug)]
pub struct Process(Child);

impl Process {
    /// Starts a command, and waits until it is ready.
    #[must_use]
    pub fn start(mut command: Command) -> Self {
        let name = format!("{command:?}");
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut said = Vec::new();
        let ready =
            lines.by_ref().map_while(Result::ok).inspect(|line| said.push(line.clone())).any(|line| line == "ready");
        assert!(ready, "{name} did not start: {said:?}");
        // Read on, so that it never blocks on its log.
        let shows = env::var_os("BRIDGE_TEST_LOG").is_some();
        std::thread::spawn(move || {
            lines
                .map_while(Result::ok)
                .filter(|line| shows || line.contains("panicked"))
                .for_each(|line| eprintln!("{line}"));
        });
        Self(child)
    }

    /// Kills it, and waits for its end.
    pub fn kill(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }

    /// Its process.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.0.id()
    }

    /// Asks it to end, and waits.
    pub fn stop(mut self) {
        let pid = i32::try_from(self.0.id()).ok().and_then(rustix::process::Pid::from_raw).unwrap();
        rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
        let begin = Instant::now();
        while self.0.try_wait().unwrap().is_none() {
            assert!(begin.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Processor time so far in ticks of 10 ms.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.0.id())).unwrap_or_default();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
        [11, 12].iter().filter_map(|&k| fields.get(k)?.parse::<u64>().ok()).sum()
    }

    /// Resident memory in bytes, without the shared memory that it has mapped.
    #[must_use]
    pub fn memory(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.0.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:")).unwrap_or("0 kB");
        1024 * line.trim().trim_end_matches(" kB").parse::<u64>().unwrap_or(0)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// The program `untangled`.
#[must_use]
pub fn untangled() -> PathBuf {
    if let Some(program) = env::var_os("BRIDGE_TEST_DAEMON") {
        return program.into();
    }
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../target");
    let programs = ["debug", "release"].map(|profile| folder.join(profile).join("untangled"));
    let newest = programs
        .iter()
        .filter(|program| program.is_file())
        .max_by_key(|program| fs::metadata(program).unwrap().modified().unwrap());
    newest
        .unwrap_or_else(|| panic!("there is no daemon: `cargo build -p untangled` in the folder above, {programs:?}"))
        .clone()
}

/// A daemon in a domain.
#[must_use]
pub fn serve(domain: &TestDomain) -> Process {
    let mut command = Command::new(untangled());
    command.args(["serve", "--domain", domain.name()]);
    Process::start(command)
}

/// The program `untangled-bridge` of the build that this program belongs to.
///
/// # Panics
/// If it is not there.
#[must_use]
pub fn bridge_program() -> PathBuf {
    let own = env::current_exe().unwrap();
    let folder = own.parent().unwrap();
    // Tests lie one folder deeper than programs.
    let folder = if folder.ends_with("deps") { folder.parent().unwrap() } else { folder };
    let program = folder.join("untangled-bridge");
    assert!(program.is_file(), "there is no {}: build it with the profile of this program", program.display());
    program
}

/// A command of the bridge's program.
#[must_use]
pub fn bridge(arguments: &[&str]) -> Command {
    let mut command = Command::new(bridge_program());
    // Not the configuration of whoever runs the test.
    command.args(arguments).env("XDG_CONFIG_HOME", "/nonexistent");
    command
}

/// An address that nobody listens on.
#[must_use]
pub fn free_address() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

/// The end near a daemon.
#[must_use]
pub fn daemon_end(domain: &TestDomain, name: &str, address: SocketAddr) -> Process {
    let address = address.to_string();
    Process::start(bridge(&["daemon", "--domain", domain.name(), "--name", name, "--listen", &address]))
}

/// The end near hosts.
#[must_use]
pub fn host_end(domain: &TestDomain, name: &str, addresses: &[SocketAddr]) -> Process {
    let mut command = bridge(&["host", "--domain", domain.name(), "--name", name]);
    for address in addresses {
        command.args(["--connect", &address.to_string()]);
    }
    Process::start(command)
}

/// A daemon, a bridge, and the domains at both ends.
#[derive(Debug)]
pub struct Bridged {
    /// The end near the host.
    pub host_end: Process,
    /// The end near the daemon.
    pub daemon_end: Process,
    /// The daemon.
    pub daemon: Process,
    /// Where the daemon end listens.
    pub address: SocketAddr,
    /// The domain of hosts.
    pub near_host: TestDomain,
    /// The domain of the daemon.
    pub near_daemon: TestDomain,
}

impl Bridged {
    /// Starts all of it, over loopback.
    #[must_use]
    pub fn start() -> Self {
        Self::start_by(|address| address)
    }

    /// The same, with a host end that connects to what stands for the address of the daemon end.
    #[must_use]
    pub fn start_by(connected: impl FnOnce(SocketAddr) -> SocketAddr) -> Self {
        let (near_host, near_daemon) = (TestDomain::new(), TestDomain::new());
        let address = free_address();
        let daemon = serve(&near_daemon);
        let daemon_end = daemon_end(&near_daemon, "far", address);
        let host_end = host_end(&near_host, "near", &[connected(address)]);
        Self { host_end, daemon_end, daemon, address, near_host, near_daemon }
    }
}
