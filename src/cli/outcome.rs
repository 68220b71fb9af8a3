//! How a command ends, and what it prints.

use std::io::{self, ErrorKind, Write};

use untangled_mesh_io::Printable;

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

/// Prints the error with which a command ends. Errors quote files, whose control characters are escaped here. Nobody may
/// be reading any more, which is no error of its own.
pub(super) fn complain(error: &CliError) {
    for (number, line) in error.to_string().lines().enumerate() {
        let start = if number == 0 { "untangled: " } else { "" };
        let _ = writeln!(io::stderr(), "{start}{}", Printable(line));
    }
}

/// A report for people as it is printed: control characters of names in it are escaped, line by line.
pub(super) fn printable(report: &str) -> String {
    report
        .split_inclusive('\n')
        .map(|line| {
            let text = line.strip_suffix('\n').unwrap_or(line);
            format!("{}{}", Printable(text), &line[text.len()..])
        })
        .collect()
}

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
