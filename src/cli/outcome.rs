//! How a command ends, and what it prints.

use std::io::{self, ErrorKind, Write};

/// How a command ended; errors end with exit code 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Done and clean: exit code 0.
    Clean,
    /// Done, but intersections remain, or a certificate could not be given: exit code 1.
    Remaining,
}

/// Any error of a command: printed as one line, then exit code 2.
pub type CliError = Box<dyn std::error::Error + Send + Sync>;

/// Prints to standard output. Returns whether there is still a reader; a closed pipe is not an error.
///
/// # Errors
/// What the system says.
pub(super) fn print(text: &str) -> io::Result<bool> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(error),
    }
}
