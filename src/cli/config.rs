//! `untangled config`.

use clap::Args;

use crate::config::{self, Config};

use super::outcome::{self, CliError, Outcome};

#[derive(Debug, Args)]
pub(super) struct ConfigArgs {
    #[command(flatten)]
    config: config::ConfigFlags,
}

pub(super) fn run(args: &ConfigArgs) -> Result<Outcome, CliError> {
    let config = Config::load(&args.config)?;
    outcome::print(&(config.explained()? + "\n"))?;
    Ok(Outcome::Clean)
}
