//! Daemons that are processes of the measuring program itself.

use std::process::Command;

use untangled::service::{self, ServeOptions, Shutdown};
use untangled_transport::Domain;

/// The running program in another role.
///
/// # Panics
/// If the system doesn't know the running program.
#[must_use]
pub fn this_program(role: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("the system knows this program"));
    command.arg(role).args(arguments);
    command
}

/// The running program as the daemon of a domain. Its `main` must lead the arguments `daemon DOMAIN` to [`serve`].
#[must_use]
pub fn daemon(domain: &str) -> Command {
    this_program("daemon", &[domain])
}

/// Serves a domain until a signal, and says `ready` on standard error.
///
/// # Panics
/// If the domain can't be served.
pub fn serve(domain: &str) {
    let domain = Domain::locate(Some(domain)).expect("the parent chose it");
    service::run(&ServeOptions::new(domain), &Shutdown::default(), || eprintln!("ready")).expect("it serves");
}
