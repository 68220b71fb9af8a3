//! An observer as a process that can be killed and stopped.

use std::{io::Write, time::Duration};

use untangled_client::observe::{ObserveError, Observer, ObserverOptions, sessions};

use super::PATIENCE;

/// What observers of tests are called.
pub const OBSERVER_NAME: &str = "an observer of a test";

/// Watches one of the sessions of a domain, by its place, without an end. Says `at opening`, `at opened`, and `at seen`
/// for each frame.
pub(super) fn observer_main(domain: &str, place: usize) {
    let name = Some(OBSERVER_NAME.to_owned());
    let options = ObserverOptions { domain: Some(domain.to_owned()), timeout: PATIENCE, name };
    loop {
        match watch(&options, place) {
            Ok(()) => {}
            // Places of observers that were killed are free again in a moment.
            Err(ObserveError::TooMany { .. }) => {}
            Err(error) if error.is_end() => {}
            Err(error) => say(&format!("wrong: {error}")),
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn watch(options: &ObserverOptions, place: usize) -> Result<(), ObserveError> {
    let Some(session) = sessions(options)?.get(place).map(|session| session.session) else { return Ok(()) };
    say("opening");
    let mut observer = Observer::open(options.clone(), session)?;
    say("opened");
    loop {
        if observer.latest(PATIENCE)?.is_some() {
            say("seen");
        }
    }
}

/// Says on standard output how far this process is.
pub(super) fn say(what: &str) {
    println!("at {what}");
    let _ = std::io::stdout().flush();
}
