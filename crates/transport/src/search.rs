//! Where else a daemon of this user serves: for the error of a client that finds none.
//!
//! Daemon and client look below the same folder only if `XDG_RUNTIME_DIR` is the same for both, which it often is not
//! with systemd, cron, ssh and su.

use std::{
    fs::File,
    path::{Path, PathBuf},
};

use rustix::fs::{FlockOperation, flock};

use crate::{
    Domain,
    domain::{FOLDER_NAME, folder_without_variable},
    folders,
};

/// Says which folder was searched for the daemon of a domain, and where else this user's daemons serve. A part of a
/// sentence, as in "no daemon serves domain `x` below /run/user/1000/untangled".
#[must_use]
pub fn explain(domain: &Domain) -> String {
    let uid = rustix::process::getuid().as_raw();
    let places = [PathBuf::from(format!("/run/user/{uid}")).join(FOLDER_NAME), folder_without_variable(uid)];
    explain_among(domain, &places)
}

fn explain_among(domain: &Domain, places: &[PathBuf]) -> String {
    let mut words = format!("below {}", domain.base().display());
    for base in places.iter().filter(|base| *base != domain.base()) {
        if served(base).iter().any(|name| name == domain.name()) {
            let hint = match base.parent().filter(|_| base.ends_with(FOLDER_NAME)) {
                Some(runtime) => format!("set XDG_RUNTIME_DIR={}", runtime.display()),
                None => "unset XDG_RUNTIME_DIR".to_owned(),
            };
            words.push_str(&format!("; one does below {} ({hint} to reach it)", base.display()));
        }
    }
    let others: Vec<String> = served(domain.base()).into_iter().filter(|name| name != domain.name()).collect();
    if !others.is_empty() {
        words.push_str(&format!("; daemons serve there as: {}", others.join(", ")));
    }
    words
}

/// Whether a daemon serves a domain: its lock is held, which ends with its process, however that ends.
#[must_use]
pub fn is_served(domain: &Domain) -> bool {
    domain.is_announced() && is_held(&domain.lock_path())
}

/// The domains below a folder that a daemon serves, in alphabetical order: their locks are held.
fn served(base: &Path) -> Vec<String> {
    let Ok(entries) = folders::check(base).map_err(drop).and_then(|_| std::fs::read_dir(base).map_err(drop)) else {
        return Vec::new();
    };
    let names = entries.flatten().filter_map(|entry| {
        let is_announced = entry.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.len() > 0);
        let name = entry.file_name().to_str()?.strip_suffix(".lock")?.to_owned();
        (is_announced && is_held(&entry.path())).then_some(name)
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Whether a daemon holds a lock. A shared lock, for a moment, keeps no other client from asking the same.
fn is_held(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| flock(&file, FlockOperation::NonBlockingLockShared).is_err())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::lock::DomainLock;

    #[test]
    fn explain_names_the_folder_searched_and_where_a_daemon_serves() {
        let top = std::env::temp_dir().join(format!("search-{}", std::process::id()));
        let uid = rustix::process::getuid().as_raw();
        let [here, there] = ["here", "there"].map(|name| Domain::new("x", Some(&top.join(name)), uid).unwrap());
        let mut lock = DomainLock::acquire(&there).unwrap();
        let places = [there.base().to_owned()];
        let not_announced = explain_among(&here, &places);
        lock.announce().unwrap();
        let announced = explain_among(&here, &places);
        let other_name = explain_among(&Domain::new("y", Some(&top.join("there")), uid).unwrap(), &places);
        drop(lock);
        let killed = explain_among(&here, &places);
        fs::remove_dir_all(&top).unwrap();
        let searched = format!("below {}", here.base().display());
        assert_eq!([&not_announced, &killed], [&searched; 2], "a lock that nobody holds is no daemon");
        assert!(announced.contains(&format!("set XDG_RUNTIME_DIR={}", top.join("there").display())), "{announced}");
        assert!(other_name.ends_with("serve there as: x"), "{other_name}");
    }
}
