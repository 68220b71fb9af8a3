//! Removes the resources of crashed hosts, as a daemon does, and logs it.

use untangled_transport::{
    Domain,
    housekeeping::{Cleanup, Finding},
};

use crate::error::BridgeError;

/// The thread of the cleanup; it ends when this is dropped.
#[derive(Debug)]
pub(crate) struct Housekeeping {
    _cleanup: Cleanup,
}

impl Housekeeping {
    pub(crate) fn start(domain: Domain) -> Result<Self, BridgeError> {
        let config = domain.config()?;
        let cleanup = Cleanup::start(domain, config, |finding| match finding {
            Finding::Unfinished(removed) => tracing::info!(removed, "segments that killed hosts left unfinished"),
            Finding::Left(removed) => tracing::info!(removed, "files that killed hosts left"),
            Finding::Failed(error) => tracing::warn!(%error, "looking for what killed hosts left"),
        });
        let cleanup =
            cleanup.map_err(|source| BridgeError::System { what: "starting the cleanup thread".to_owned(), source })?;
        Ok(Self { _cleanup: cleanup })
    }
}
