//! Several hosts on one machine: network namespaces, joined by shaped links that lose packets on demand.
//!
//! Needs root, `ip` and `tc` of iproute2, and `nft` for loss and cuts. Shared memory is the machine's: domains keep the
//! hosts apart.

use std::process::Command;

/// What a link carries, in the words of `tc`.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// As in `1gbit`.
    pub rate: &'a str,
    /// What may leave at once after a pause, as in `16kb`. Segments that are longer are cut, at the cost of processor
    /// time that a network card would not take.
    pub burst: &'a str,
}

impl<'a> Shape<'a> {
    /// As exact in time as the kernel does it: at 1 Gbit/s a state of 190 kB takes its 1.5 ms.
    #[must_use]
    pub const fn exact(rate: &'a str) -> Self {
        Self { rate, burst: "16kb" }
    }
}

/// A namespace for the host, and one for each daemon, each joined with that of the host by a link of its own.
#[derive(Debug)]
pub struct Namespaces {
    num_daemons: usize,
}

const HOST: &str = "untangled-host";

pub(crate) fn daemon_ip(k: usize) -> String {
    format!("10.77.{k}.2")
}

fn daemon_name(k: usize) -> String {
    format!("untangled-daemon-{k}")
}

fn run(program: &str, arguments: &str) -> Result<(), String> {
    let output = Command::new(program).args(arguments.split_whitespace()).output();
    let output = output.map_err(|error| format!("{program}: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!("{program} {arguments}: {}", String::from_utf8_lossy(&output.stderr).trim()))
}

impl Namespaces {
    /// Makes them, each link with this shape.
    ///
    /// # Errors
    /// What the system says where it does not allow it.
    pub fn new(num_daemons: usize, shape: Option<Shape<'_>>) -> Result<Self, String> {
        let made = Self { num_daemons };
        made.remove();
        run("ip", &format!("netns add {HOST}"))?;
        run("ip", &format!("-n {HOST} link set lo up"))?;
        for k in 0..num_daemons {
            let daemon = daemon_name(k);
            run("ip", &format!("netns add {daemon}"))?;
            run("ip", &format!("-n {daemon} link set lo up"))?;
            run("ip", &format!("-n {HOST} link add to{k} type veth peer name eth netns {daemon}"))?;
            for (namespace, device, last) in [(HOST, format!("to{k}"), 1), (&*daemon, "eth".to_owned(), 2)] {
                run("ip", &format!("-n {namespace} addr add 10.77.{k}.{last}/24 dev {device}"))?;
                run("ip", &format!("-n {namespace} link set {device} up"))?;
                if let Some(Shape { rate, burst }) = shape {
                    let shape = format!("root tbf rate {rate} burst {burst} latency 50ms");
                    run("tc", &format!("-n {namespace} qdisc add dev {device} {shape}"))?;
                }
            }
        }
        Ok(made)
    }

    fn remove(&self) {
        for k in 0..self.num_daemons {
            let _ = run("ip", &format!("netns del {}", daemon_name(k)));
        }
        let _ = run("ip", &format!("netns del {HOST}"));
    }

    /// The address of a daemon end.
    #[must_use]
    pub fn address(&self, k: usize) -> String {
        format!("{}:7460", daemon_ip(k))
    }

    /// A command in the namespace of the host.
    #[must_use]
    pub fn in_host(&self, command: &Command) -> Command {
        inside(HOST, command)
    }

    /// A command in the namespace of a daemon.
    #[must_use]
    pub fn in_daemon(&self, k: usize, command: &Command) -> Command {
        inside(&daemon_name(k), command)
    }

    /// Loses so many of a hundred packets in each direction, at random; all of them is a cut.
    ///
    /// # Errors
    /// What `nft` says.
    pub fn lose(&self, percent: u32) -> Result<(), String> {
        let namespaces = (0..self.num_daemons).map(daemon_name).chain([HOST.to_owned()]);
        for namespace in namespaces {
            let _ = run("ip", &format!("netns exec {namespace} nft delete table inet loss"));
            if percent == 0 {
                continue;
            }
            run("ip", &format!("netns exec {namespace} nft add table inet loss"))?;
            let hook = "{ type filter hook output priority 0 ; }";
            run("ip", &format!("netns exec {namespace} nft add chain inet loss out {hook}"))?;
            let chance = if percent < 100 { format!("numgen random mod 100 < {percent}") } else { String::new() };
            let rule = format!("ip daddr 10.77.0.0/16 {chance} drop");
            run("ip", &format!("netns exec {namespace} nft add rule inet loss out {rule}"))?;
        }
        Ok(())
    }
}

impl Drop for Namespaces {
    fn drop(&mut self) {
        self.remove();
    }
}

fn inside(namespace: &str, command: &Command) -> Command {
    let mut inside = Command::new("ip");
    inside.args(["netns", "exec", namespace]).arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => inside.env(name, value),
            None => inside.env_remove(name),
        };
    }
    inside
}
