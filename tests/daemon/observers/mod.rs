//! Observers of sessions: what they see, and what their faults cost.

mod ends;
mod frames;
mod requests;

use untangled_client::observe::{Observer, ObserverOptions};
use untangled_testkit::process::{PATIENCE, TestDomain};

fn options(domain: &TestDomain) -> ObserverOptions {
    ObserverOptions { domain: Some(domain.name().to_owned()), timeout: PATIENCE, name: None }
}

/// An observer of the only session of a domain.
fn observe(domain: &TestDomain) -> Observer {
    let options = options(domain);
    let found = untangled_client::observe::sessions(&options).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    Observer::open(options, found[0].session).unwrap()
}
