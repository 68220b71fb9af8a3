//! Daemons and a bridge to them, over a link of some rate, in the clear or not.

use std::{
    process::Command,
    time::{Duration, Instant},
};

use untangled_bridge_lab::{
    certificates::Authority,
    cloth::Fold,
    ends::{self, PATIENCE, Process, TestDomain},
    network::Namespaces,
};

use crate::link::{Link, in_daemon, in_host};

/// A sheet of 31,250 triangles.
pub(crate) const LARGE: Fold = Fold::new(126);
/// A sheet of 7,938 triangles.
pub(crate) const SMALL: Fold = Fold::new(64);

/// What the ends do with their messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Messages {
    /// They go out as they are.
    Clear,
    /// They are compressed (LZ4).
    Compressed,
    /// They go through TLS, with certificates on both sides.
    Encrypted,
}

impl Messages {
    pub(crate) const ALL: [Self; 3] = [Self::Clear, Self::Compressed, Self::Encrypted];

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Clear => "in the clear",
            Self::Compressed => "compressed",
            Self::Encrypted => "TLS",
        }
    }
}

/// Daemons, a bridge to them, and what joins them. Fields are dropped in order: processes before namespaces.
pub(crate) struct Setting {
    /// The daemon ends, then the host end.
    pub(crate) ends: Vec<Process>,
    _proxies: Vec<Process>,
    _daemons: Vec<Process>,
    pub(crate) near_host: TestDomain,
    pub(crate) near_daemons: Vec<TestDomain>,
    _namespaces: Option<Namespaces>,
    _authority: Option<Authority>,
    pub(crate) words: String,
}

impl Setting {
    /// Each daemon behind a link of its own.
    pub(crate) fn start(num_daemons: usize, link: Link<'_>, messages: Messages) -> Self {
        let (namespaces, words) = match Namespaces::new(num_daemons, Some(link.shape)) {
            Ok(made) => (Some(made), format!("namespaces, veth, {}{}", link.shape.rate, link.words())),
            Err(reason) => (None, format!("loopback (no namespaces: {reason}){}", link.words())),
        };
        let authority = (messages != Messages::Clear).then(|| Authority::new("measured").unwrap());
        // What the command line does not say of an end.
        let configured = |name: &str, command: &mut Command| match (messages, &authority) {
            (Messages::Encrypted, Some(authority)) => {
                command.arg("--config").arg(authority.config(name, "", "", &authority.certificate()));
            }
            (Messages::Compressed, Some(authority)) => {
                command.arg("--config").arg(authority.write(name, "compression = true\ninsecure = true\n"));
            }
            _ => {
                command.arg("--insecure");
            }
        };
        let near_host = TestDomain::new();
        let near_daemons: Vec<TestDomain> = (0..num_daemons).map(|_| TestDomain::new()).collect();
        let _daemons = near_daemons.iter().map(ends::serve).collect();
        let mut started = Vec::new();
        let mut addresses = Vec::new();
        for (k, domain) in near_daemons.iter().enumerate() {
            let free = ends::free_address().to_string();
            let address = namespaces.as_ref().map_or(free, |made| made.address(k));
            let name = format!("far-{k}");
            let mut command =
                ends::bridge(&["daemon", "--domain", domain.name(), "--name", &name, "--listen", &address]);
            configured(&name, &mut command);
            started.push(Process::start(in_daemon(namespaces.as_ref(), k, &command)));
            addresses.push(address);
        }
        let mut command = ends::bridge(&["host", "--domain", near_host.name(), "--name", "near"]);
        configured("near", &mut command);
        let mut _proxies = Vec::new();
        for address in addresses {
            let (proxy, near) = link.proxy(namespaces.as_ref(), &address).unzip();
            command.args(["--connect", &near.unwrap_or(address)]);
            _proxies.extend(proxy);
        }
        started.push(Process::start(in_host(namespaces.as_ref(), &command)));
        wait_for(&near_host, num_daemons);
        let (_namespaces, _authority) = (namespaces, authority);
        Self { ends: started, _proxies, _daemons, near_host, near_daemons, _namespaces, _authority, words }
    }

    /// Bytes of a frame on their way to the daemon, and back, on the average so far.
    pub(crate) fn frame_bytes(&self) -> [f64; 2] {
        let report = self.near_host.connect().status().unwrap();
        let bridge = &report["bridge"];
        [("bytes_sent", "num_sent"), ("bytes_received", "num_received")]
            .map(|(bytes, count)| bridge[bytes].as_f64().unwrap() / bridge[count].as_f64().unwrap())
    }

    /// How many sessions each daemon has that has any.
    pub(crate) fn places(&self) -> Vec<usize> {
        let report = self.near_host.connect().status().unwrap();
        let sessions = report["bridge"]["sessions"].as_array().unwrap();
        let mut places: Vec<String> = sessions.iter().map(|session| session["daemon"].to_string()).collect();
        places.sort();
        places.chunk_by(|one, next| one == next).map(<[String]>::len).collect()
    }

    /// Processor time of each end so far, in ticks of 10 ms.
    pub(crate) fn ticks(&self) -> Vec<u64> {
        self.ends.iter().map(Process::ticks).collect()
    }
}

/// Until a host end has heard of so many daemons.
fn wait_for(near_host: &TestDomain, num_daemons: usize) {
    let client = near_host.connect();
    let begin = Instant::now();
    while client.status().unwrap()["bridge"]["daemons"].as_array().unwrap().len() < num_daemons {
        assert!(begin.elapsed() < PATIENCE, "not all daemons are heard of");
        std::thread::sleep(Duration::from_millis(50));
    }
}
