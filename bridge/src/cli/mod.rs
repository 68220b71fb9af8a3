//! The command line: `host`, `daemon`, `status`, `config`.

mod lines;
mod serve;
mod status;

use std::{io::Write, path::PathBuf, process::ExitCode};

use clap::{Args, Parser, Subcommand};

use crate::{
    config::{self, Config},
    error::BridgeError,
    net::Side,
};

/// Untangling on another machine: carries live sessions between hosts here and daemons elsewhere.
///
/// `untangled-bridge daemon` runs beside a daemon (`untangled serve`), `untangled-bridge host` beside the simulators.
/// Hosts need no change: they find a daemon in their domain.
///
/// Exit codes: 0 ended as asked, 2 bad usage, bad configuration or another error.
#[derive(Debug, Parser)]
#[command(name = "untangled-bridge", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the end near the hosts: serves a local domain by daemons elsewhere.
    Host(HostArgs),
    /// Run the end near a daemon: serves hosts elsewhere by the daemon of a local domain.
    Daemon(DaemonArgs),
    /// Say what a running end does; it must serve metrics.
    Status(status::StatusArgs),
    /// Print the effective configuration, each key explained.
    Config(CommonArgs),
}

#[derive(Debug, Args)]
struct HostArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// Where daemon ends listen, HOST:PORT; may be given several times, and replaces the configuration's.
    #[arg(long, value_name = "ADDRESS")]
    connect: Vec<String>,
}

#[derive(Debug, Args)]
struct DaemonArgs {
    #[command(flatten)]
    common: CommonArgs,
    /// Where to listen, HOST:PORT; may be given several times, and replaces the configuration's.
    #[arg(long, value_name = "ADDRESS")]
    listen: Vec<String>,
}

#[derive(Debug, Args)]
struct CommonArgs {
    /// The configuration; the default is ~/.config/untangled/bridge.toml where it is there.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// The local domain; the default is $UNTANGLED_DOMAIN, else `default`.
    #[arg(long, value_name = "NAME")]
    domain: Option<String>,
    /// The name of this end, which no other end may have.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Find other ends by multicast.
    #[arg(long)]
    discovery: bool,
    /// Use addresses beyond this machine without certificates: everybody who can connect can use the daemon.
    #[arg(long)]
    insecure: bool,
    /// Serve metrics and status over HTTP on this loopback address, as in `127.0.0.1:9465`.
    #[arg(long, value_name = "ADDRESS")]
    metrics: Option<String>,
    /// What to log, as in `info` or `untangled_bridge=debug`.
    #[arg(long, value_name = "FILTER")]
    log: Option<String>,
}

impl CommonArgs {
    fn load(&self) -> Result<Config, BridgeError> {
        let mut config = Config::load(self.config.as_deref())?;
        let given = [
            (&self.domain, &mut config.domain),
            (&self.name, &mut config.name),
            (&self.metrics, &mut config.telemetry.metrics),
            (&self.log, &mut config.telemetry.filter),
        ];
        for (flag, value) in given {
            if let Some(flag) = flag {
                value.clone_from(flag);
            }
        }
        config.discovery |= self.discovery;
        config.insecure |= self.insecure;
        Ok(config)
    }
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody may read it.
            let _ = writeln!(std::io::stderr(), "untangled-bridge: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<(), BridgeError> {
    match command {
        Command::Host(args) => {
            let mut config = args.common.load()?;
            if !args.connect.is_empty() {
                config.connect = args.connect;
            }
            serve::run(&config, Side::Host)
        }
        Command::Daemon(args) => {
            let mut config = args.common.load()?;
            if !args.listen.is_empty() {
                config.listen = args.listen;
            }
            serve::run(&config, Side::Daemon)
        }
        Command::Status(args) => status::run(&args),
        Command::Config(args) => {
            let text = config::print(&args.load()?);
            // A reader may leave before the end.
            let _ = std::io::stdout().write_all(text.as_bytes());
            Ok(())
        }
    }
}
