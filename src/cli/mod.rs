//! The command line: subcommands, and the exit codes that scripts rely on.
//!
//! | module | purpose |
//! |---|---|
//! | `outcome` | how a command ends, and printing |
//! | `progress_line` | what is being done, on standard error |
//! | `wording` | words that reports, tables and pictures share |
//! | `weld` | `--weld`: which vertices in one place are one vertex |
//! | `input` | mesh files as one world, for `check` and `fix` |
//! | `join` | parts of a cache, repaired by several machines, as one file |
//! | `roles` | bodies beside the cloth, and layers: `--body`, `--layers` |
//! | `owners` | the file, object or group of a vertex or a face |
//! | `certificate` | what readers of a file find in it, by the judge |
//! | `gap` | `--gap`: the distance that primitives keep |
//! | `world` | the arguments that `check` and `fix` have in common |
//! | `html` | `--html`: a page to look at |
//! | `picture` | pictures of a cloth and its intersection paths, for `demo` |
//! | `sequence` | `check` and `fix` with `--cache` or `--prim`: frame after frame |
//! | `packaging` | `completions` and `man`: what packages carry beside the program |
//! | `watch` | a page that shows live sessions |
//! | `check`, `fix`, `demo`, `serve`, `status`, `config` | one subcommand each |

mod certificate;
pub mod check;
mod config;
pub mod demo;
pub mod fix;
pub mod gap;
mod html;
pub mod input;
mod join;
mod outcome;
mod owners;
mod packaging;
pub mod picture;
mod progress_line;
pub mod roles;
pub mod sequence;
mod serve;
mod status;
mod watch;
mod weld;
mod wording;
mod world;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

pub use outcome::{CliError, Outcome};

use crate::config::InstructionSet;

/// Resolves cloth intersections for other simulators: global intersection analysis and response, over shared memory or
/// on files.
///
/// Exit codes: 0 done and clean, 1 done but intersections remain, 2 bad usage, bad input or another error.
#[derive(Debug, Parser)]
#[command(name = "untangled", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the daemon until SIGINT, SIGTERM or SIGHUP; prints `ready` on standard error when it serves.
    Serve(serve::ServeArgs),
    /// Say what a running daemon does: sessions, frames, rates, stage times.
    Status(status::StatusArgs),
    Watch(watch::WatchArgs),
    /// Print the effective configuration, each key explained.
    Config(config::ConfigArgs),
    Check(check::CheckArgs),
    Fix(fix::FixArgs),
    Join(join::JoinArgs),
    Demo(demo::DemoArgs),
    Completions(packaging::CompletionsArgs),
    Man(packaging::ManArgs),
    /// Simulate a cloth as the example host does; `demo` starts this as a process of its own.
    #[command(hide = true)]
    Publish(untangled_publisher::cli::PublishArgs),
}

/// Runs the command line of this process.
#[must_use]
pub fn main() -> ExitCode {
    // A usage error ends with exit code 2 and the usage, help and version with 0.
    let command = Cli::parse().command;
    let result = match InstructionSet::from_environment() {
        Ok(instructions) => {
            instructions.choose();
            run(command)
        }
        Err(error) => Err(error.into()),
    };
    match result {
        Ok(Outcome::Clean) => ExitCode::SUCCESS,
        Ok(Outcome::Remaining) => ExitCode::from(1),
        Err(error) => {
            outcome::complain(&error);
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<Outcome, CliError> {
    match command {
        Command::Serve(args) => serve::run(&args),
        Command::Status(args) => status::run(&args),
        Command::Watch(args) => watch::run(&args),
        Command::Config(args) => config::run(&args),
        Command::Check(args) if args.world.sequence.is_asked() => sequence::check(&args).map_err(Into::into),
        Command::Check(args) => check::run(&args).map_err(Into::into),
        Command::Fix(args) if args.world.sequence.is_asked() => sequence::fix(&args).map_err(Into::into),
        Command::Fix(args) => fix::run(&args).map_err(Into::into),
        Command::Join(args) => join::run(&args),
        Command::Demo(args) => demo::run(&args, &mut std::io::stdout()).map_err(Into::into),
        Command::Completions(args) => packaging::completions(&args, Cli::command()),
        Command::Man(args) => packaging::man(&args, Cli::command()),
        Command::Publish(args) => demo::publish(&args).map_err(Into::into),
    }
}
