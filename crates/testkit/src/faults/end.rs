//! How a trial ends.

use rustix::process::Signal;

use crate::process::{Daemon, TestDomain};

/// Open sessions of the domain's daemon.
pub(super) fn num_sessions(domain: &TestDomain) -> usize {
    let status = domain.connect().status().expect("the daemon answers");
    status["sessions"].as_array().map_or(0, Vec::len)
}

/// Observers of the first session of the domain's daemon.
pub(super) fn num_observers(domain: &TestDomain) -> usize {
    let status = domain.connect().status().expect("the daemon answers");
    status["sessions"][0]["observers"].as_array().map_or(0, Vec::len)
}

/// Ends a daemon and asserts that it leaves nothing.
pub(super) fn end_cleanly(daemon: Daemon, domain: &TestDomain) {
    assert!(daemon.stop(Signal::TERM).success(), "the daemon ends well");
    domain.assert_nothing_left();
}
