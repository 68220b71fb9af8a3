//! `untangled config`.

use clap::Args;

use crate::config::{self, Config};

use super::{CliError, Outcome};

#[derive(Debug, Args)]
pub(super) struct ConfigArgs {
    #[command(flatten)]
    config: config::ConfigFlags,
}

pub(super) fn run(args: &ConfigArgs) -> Result<Outcome, CliError> {
    let config = Config::load(&args.config)?;
    super::print(&config.explained()?)?;
    Ok(Outcome::Clean)
}
