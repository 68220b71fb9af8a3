//! What packages of the program carry beside it, made from the command line itself: completions for shells, and manual
//! pages.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use clap_complete::Shell;
use clap_mangen::Man;
use thiserror::Error;

use super::outcome::{CliError, Outcome};

/// Print completions for a shell: `untangled completions bash > ~/.local/share/bash-completion/completions/untangled`.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Write manual pages into a folder: one for the program and one for each command.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct ManArgs {
    /// The folder; pages that are there are replaced
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// A page that could not be written.
#[derive(Debug, Error)]
#[error("{path}: {source}")]
struct PageError {
    path: PathBuf,
    source: io::Error,
}

/// `untangled completions`: the script for a shell on standard output.
pub(super) fn completions(args: &CompletionsArgs, mut program: clap::Command) -> Result<Outcome, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "untangled", &mut script);
    super::outcome::print(&String::from_utf8_lossy(&script))?;
    Ok(Outcome::Clean)
}

/// `untangled man`: pages named as `untangled-check.1`.
pub(super) fn man(args: &ManArgs, mut program: clap::Command) -> Result<Outcome, CliError> {
    program.build();
    write_page(&args.folder, "untangled", program.clone())?;
    for command in program.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help") {
        write_page(&args.folder, &format!("untangled-{}", command.get_name()), command.clone())?;
    }
    Ok(Outcome::Clean)
}

fn write_page(folder: &Path, name: &str, command: clap::Command) -> Result<(), CliError> {
    let path = folder.join(format!("{name}.1"));
    let mut page = Vec::new();
    let written = Man::new(command).render(&mut page).and_then(|()| fs::write(&path, &page));
    written.map_err(|source| PageError { path, source }.into())
}
