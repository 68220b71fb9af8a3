//! Where frames come from. The server knows this much of it; tests have one that is made up.

use std::{sync::Arc, time::Duration};

use serde::Serialize;

/// Live sessions.
pub(super) trait Source: Send + Sync {
    /// Which daemon this is, in words.
    fn name(&self) -> &str;

    /// The sessions that are there now.
    ///
    /// # Errors
    /// Words that say why there are none, in particular that no daemon runs.
    fn sessions(&self) -> Result<Vec<SessionLine>, String>;

    /// Begins to look at one, on the thread that will go on.
    ///
    /// # Errors
    /// Words that say why this is not possible.
    fn open(&self, session: &str) -> Result<Box<dyn Feed>, String>;
}

/// The frames of one session, of which the newest counts.
pub(super) trait Feed {
    /// What does not change from frame to frame, as a message for the page.
    fn mesh(&self) -> Arc<[u8]>;

    /// The newest frame that was not asked for yet, as a message; those before it are lost. Nothing on timeout.
    ///
    /// # Errors
    /// Words that say why there will be no more.
    fn latest(&mut self, timeout: Duration) -> Result<Option<Arc<[u8]>>, String>;
}

/// What the list of sessions says of one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct SessionLine {
    /// Its name for [`Source::open`]: no two sessions have one name, those of a daemon that was restarted neither.
    pub(super) session: String,
    /// Whose it is, in words.
    pub(super) host: String,
    pub(super) num_vertices: u64,
    pub(super) num_faces: u64,
    pub(super) num_frames: u64,
}
