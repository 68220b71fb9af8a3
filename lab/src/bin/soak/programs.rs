//! The processes of a trial: this program in other roles.

use std::process::Command;

use untangled_lab::daemon::{daemon, this_program};
use untangled_testkit::process::Programs;

/// Daemons and clients.
pub(crate) const PROGRAMS: Programs = Programs { daemon, client };

fn client(domain: &str, role: &str) -> Command {
    this_program("client", &[domain, role])
}

/// The process at the other end of a Unix socket.
pub(crate) fn echo(path: &str, num_vertices: usize) -> Command {
    this_program("echo", &[path, &num_vertices.to_string()])
}
