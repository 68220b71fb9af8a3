//! Observers as processes of this program.

use std::{
    io::{BufRead, BufReader, Write},
    process::{Child, Stdio},
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::observe::{Observer, ObserverOptions, sessions};
use untangled_lab::daemon::this_program;
use untangled_testkit::process::{PATIENCE, TestDomain, eventually, send_signal};

/// Observers of a row: how many, how often they look (in Hz, 0 for each frame), and whether the last one is stopped.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) num_observers: usize,
    pub(crate) rate_hz: u32,
    pub(crate) is_one_stopped: bool,
}

/// Watches the only session, and says so once it has seen a frame.
pub(crate) fn watch(domain: &str, rate_hz: u32) {
    let options = ObserverOptions { domain: Some(domain.to_owned()), timeout: PATIENCE, name: None };
    let session = sessions(&options).unwrap()[0].session;
    let mut observer = Observer::open(options, session).unwrap();
    let mut said = false;
    while let Ok(seen) = observer.latest(PATIENCE) {
        std::hint::black_box(&seen);
        if !said {
            println!("seen");
            std::io::stdout().flush().unwrap();
            said = true;
        }
        if rate_hz > 0 {
            std::thread::sleep(Duration::from_secs(1) / rate_hz);
        }
    }
}

/// The observers of a row, as processes.
pub(crate) struct Observers(Vec<Child>);

impl Observers {
    /// Starts them, and sends frames until each has seen one.
    pub(crate) fn start(row: &Row, domain: &TestDomain, mut frame: impl FnMut()) -> Self {
        let start = |_| {
            let mut command = this_program("observe", &[domain.name(), &row.rate_hz.to_string()]);
            command.stdout(Stdio::piped()).spawn().unwrap()
        };
        let mut children: Vec<Child> = (0..row.num_observers).map(start).collect();
        let waiting: Vec<_> = children
            .iter_mut()
            .map(|child| {
                let lines = BufReader::new(child.stdout.take().unwrap());
                std::thread::spawn(move || lines.lines().map_while(Result::ok).any(|line| line == "seen"))
            })
            .collect();
        while !waiting.iter().all(std::thread::JoinHandle::is_finished) {
            frame();
        }
        if row.is_one_stopped {
            send_signal(&children[row.num_observers - 1], Signal::STOP);
        }
        Self(children)
    }

    /// Kills them, and waits until the daemon has noticed.
    pub(crate) fn end(mut self, domain: &TestDomain) {
        for child in &mut self.0 {
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let options = ObserverOptions { domain: Some(domain.name().to_owned()), timeout: PATIENCE, name: None };
        eventually("nobody watches", || sessions(&options).unwrap()[0].observers.is_empty());
    }
}
