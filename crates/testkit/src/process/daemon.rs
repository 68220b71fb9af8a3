//! A daemon as a process.

use std::{
    env,
    io::{BufRead, BufReader},
    process::{Child, Command, ExitStatus, Stdio},
};

use rustix::process::{Pid, Signal, kill_process};

use super::{TestDomain, program};

/// How to start daemons and clients: tests take the built program and a test of theirs, the laboratory takes its own
/// program twice.
#[derive(Clone, Copy, Debug)]
pub struct Programs {
    /// A daemon of the domain with this name; it says `ready` on standard error.
    pub daemon: fn(&str) -> Command,
    /// [`client_main`](super::client_main) with the name of a domain and a role.
    pub client: fn(&str, &str) -> Command,
}

impl Programs {
    /// Starts a daemon. Only panics in its log are shown; the variable `SOAK_LOG` shows all of it.
    pub fn start_daemon(self, domain: &TestDomain) -> Daemon {
        let all = env::var_os("SOAK_LOG").is_some();
        Daemon::spawn((self.daemon)(domain.name()), move |line| all || line.contains("panicked"))
    }
}

/// A daemon process that has said `ready`. Dropping it kills it.
#[derive(Debug)]
pub struct Daemon(Child);

impl Daemon {
    /// Starts the built program in a domain, and shows its log where a test fails.
    pub fn start(domain: &TestDomain) -> Self {
        Self::start_as(program::serve(domain))
    }

    /// Starts a daemon by a command of the caller's, and shows its log where a test fails.
    pub fn start_as(command: Command) -> Self {
        Self::spawn(command, |_| true)
    }

    fn spawn(mut command: Command, is_shown: impl Fn(&str) -> bool + Send + 'static) -> Self {
        let mut child = command.stderr(Stdio::piped()).spawn().expect("the daemon's program is there");
        let mut lines = BufReader::new(child.stderr.take().expect("it is a pipe")).lines();
        let mut said = Vec::new();
        let ready =
            lines.by_ref().map_while(Result::ok).inspect(|line| said.push(line.clone())).any(|line| line == "ready");
        assert!(ready, "the daemon did not start: {said:?}");
        // Read on, so that the daemon never blocks on its log.
        std::thread::spawn(move || {
            lines.map_while(Result::ok).filter(|line| is_shown(line)).for_each(|line| eprintln!("{line}"));
        });
        Self(child)
    }

    /// Its process.
    pub fn pid(&self) -> u32 {
        self.0.id()
    }

    /// Whether it has not ended.
    pub fn is_running(&mut self) -> bool {
        self.0.try_wait().is_ok_and(|status| status.is_none())
    }

    /// Sends a signal and waits for its end.
    pub fn stop(mut self, signal: Signal) -> ExitStatus {
        send_signal(&self.0, signal);
        self.0.wait().expect("it was started here")
    }

    /// Resident memory in bytes, without the shared memory that it has mapped.
    pub fn memory(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.pid())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:")).unwrap_or("0 kB");
        1024 * line.trim().trim_end_matches(" kB").parse::<u64>().unwrap_or(0)
    }

    /// Processor time so far in ticks of 10 ms.
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

/// The id of a child process.
pub fn pid(child: &Child) -> Pid {
    i32::try_from(child.id()).ok().and_then(Pid::from_raw).expect("a process has an id")
}

/// Sends a signal to a child process that was not waited for yet.
pub fn send_signal(child: &Child, signal: Signal) {
    kill_process(pid(child), signal).expect("it was not waited for yet");
}
