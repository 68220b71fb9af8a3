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

/// Waits until there are no more items than before; panics after [`PATIENCE`] and names the new ones.
pub fn eventually_no_more<T: PartialEq + std::fmt::Debug>(what: &str, before: &[T], now: impl Fn() -> Vec<T>) {
    let end = Instant::now() + PATIENCE;
    loop {
        let items = now();
        if items.len() <= before.len() {
            return;
        }
        if Instant::now() >= end {
            let new: Vec<T> = items.into_iter().filter(|item| !before.contains(item)).collect();
            panic!("never: no more {what}; new ones are {new:?}");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}
