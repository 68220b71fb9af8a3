//! `untangled config`.

use std::io::Write;

use clap::Args;

use crate::config::{self, Config};

use super::outcome::{self, CliError, Outcome};

#[derive(Debug, Args)]
pub(super) struct ConfigArgs {
    #[command(flatten)]
    config: config::ConfigFlags,
}

pub(super) fn run(args: &ConfigArgs) -> Result<Outcome, CliError> {
    let (config, warnings) = Config::load(&args.config)?;
    for warning in warnings {
        // Nobody may be reading any more.
        let _ = writeln!(std::io::stderr(), "untangled: warning: {warning}");
    }
    outcome::print(&(config.explained()? + "\n"))?;
    Ok(Outcome::Clean)
}
