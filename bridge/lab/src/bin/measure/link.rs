//! What lies between the ends: a rate, and the time that bytes are on the way.

use std::{env, net::SocketAddr, process::Command, thread, time::Duration};

use untangled_bridge_lab::{
    ends::{self, Process},
    network::{Namespaces, Shape},
    proxy::Proxy,
};

/// The way between a host and each of its daemons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<'a> {
    pub(crate) shape: Shape<'a>,
    /// In each direction.
    pub(crate) delay: Duration,
}

impl Link<'static> {
    /// 1 Gbit/s, and no delay but that of the machine.
    pub(crate) const GIGABIT: Self = Self::new("1gbit");

    /// 1 Gbit/s, near and across a building.
    pub(crate) const NEAR_AND_FAR: [Self; 2] = [Self::GIGABIT, Self::GIGABIT.delayed(Duration::from_micros(200))];
}

impl<'a> Link<'a> {
    pub(crate) const fn new(rate: &'a str) -> Self {
        Self { shape: Shape::exact(rate), delay: Duration::ZERO }
    }

    /// For the mean of many sessions: states of 100 kB pass at once after a pause, and are not cut.
    pub(crate) const fn in_bursts(self) -> Self {
        Self { shape: Shape { burst: "256kb", ..self.shape }, ..self }
    }

    pub(crate) const fn delayed(self, delay: Duration) -> Self {
        Self { delay, ..self }
    }

    /// The delay, where there is one.
    pub(crate) fn words(&self) -> String {
        if self.delay.is_zero() {
            return String::new();
        }
        format!(", {} ms each way (bytes of a proxy)", self.delay.as_secs_f64() * 1e3)
    }

    /// Where the host connects to instead of an address: a proxy beside the host, in a process of its own, since it has
    /// to be in the namespace of the host.
    pub(crate) fn proxy(&self, namespaces: Option<&Namespaces>, target: &str) -> Option<(Process, String)> {
        if self.delay.is_zero() {
            return None;
        }
        let near = ends::free_address().to_string();
        let mut command = Command::new(env::current_exe().unwrap());
        command.args(["delay", &near, target, &self.delay.as_micros().to_string()]);
        let command = in_host(namespaces, &command);
        Some((Process::start(command), near))
    }
}

/// A command in the namespace of the host, where there is one.
pub(crate) fn in_host(namespaces: Option<&Namespaces>, command: &Command) -> Command {
    namespaces.map_or_else(|| same_command(command), |made| made.in_host(command))
}

/// A command in the namespace of a daemon, where there is one.
pub(crate) fn in_daemon(namespaces: Option<&Namespaces>, k: usize, command: &Command) -> Command {
    namespaces.map_or_else(|| same_command(command), |made| made.in_daemon(k, command))
}

fn same_command(command: &Command) -> Command {
    let mut same = Command::new(command.get_program());
    same.args(command.get_args()).env("XDG_CONFIG_HOME", "/nonexistent");
    same
}

/// `delay ADDRESS TARGET MICROSECONDS`: is such a proxy until it is killed.
pub(crate) fn delay(arguments: &[String]) {
    let [address, target, delay_us] = arguments else { panic!("delay ADDRESS TARGET MICROSECONDS") };
    let [address, target] = [address, target].map(|text| text.parse::<SocketAddr>().unwrap());
    let proxy = Proxy::start_at(address, target);
    proxy.delay(Duration::from_micros(delay_us.parse().unwrap()));
    eprintln!("ready");
    loop {
        thread::park();
    }
}
