//! The example host as a program of its own.

use std::process::ExitCode;

use clap::Parser;
use untangled_publisher::cli::{self, Cli};

fn main() -> ExitCode {
    cli::main(&Cli::parse().args)
}
