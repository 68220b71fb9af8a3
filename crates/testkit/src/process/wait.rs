//! Waiting for what another process does.

use std::time::{Duration, Instant};

/// Far beyond what anything takes; only a failure waits this long.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Waits until `holds` returns true; panics after [`PATIENCE`].
pub fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < end, "never: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
