//! `untangled watch`: a page on a loopback address that shows live sessions.
//!
//! The page asks for the newest frame whenever it has drawn one; a slow page loses frames, and the session knows
//! nothing of it. Each module uses those above it in this table only.
//!
//! | file | purpose |
//! |---|---|
//! | `message` | JSON and arrays as one message |
//! | `source` | where frames come from |
//! | `observed` | from a daemon |
//! | `channel` | one session that pages look at |
//! | `hub` | all of them |
//! | `web` | the page over HTTP |

mod channel;
mod hub;
mod message;
mod observed;
mod source;
#[cfg(test)]
mod tests;
mod web;

use std::{os::unix::net::UnixStream, sync::Arc};

use clap::Args;
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    low_level::pipe,
};
use untangled_transport::Domain;

use self::{hub::Hub, observed::Observed, web::Server};
use super::outcome::{self, CliError, Outcome};

/// Show live sessions in a browser: cloth, intersection paths, corrections, numbers over time.
///
/// Prints the address of a page on this machine, and serves it until Ctrl-C. The address has a token, without which
/// nobody gets an answer. Without a daemon the page waits for one.
#[derive(Debug, Args)]
#[command(after_help = "\
The page is at a loopback address only. From another machine: `ssh -L 8000:127.0.0.1:PORT HOST`, and the same address \
with port 8000. Nothing is loaded from anywhere else, and nothing is sent.")]
pub(super) struct WatchArgs {
    /// Which daemon; the default is $UNTANGLED_DOMAIN, else `default`.
    #[arg(long, value_name = "NAME")]
    domain: Option<String>,
    /// Port of the page; the default is any that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
}

pub(super) fn run(args: &WatchArgs) -> Result<Outcome, CliError> {
    let domain = Domain::locate(args.domain.as_deref())?;
    let (ending, signals) = UnixStream::pair()?;
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        pipe::register(signal, signals.try_clone()?)?;
    }
    let hub = Hub::new(Arc::new(Observed::new(domain.name())));
    let server = Server::bind(args.port, hub).map_err(|error| match args.port {
        0 => format!("opening a port: {error}"),
        port => format!("--port {port}: {error}"),
    })?;
    outcome::print(&format!("{}\n", server.page()?))?;
    server.run(&ending)?;
    Ok(Outcome::Clean)
}
