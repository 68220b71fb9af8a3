//! The host ends that this daemon end serves: their links, and what each may take.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use super::link::Link;
use crate::wire::beacon::HostBeacon;

/// A host end of which nothing was heard for so long has left: its sessions are closed.
const LEFT_AFTER: Duration = Duration::from_secs(3);
/// How long a new link may be missing in the beacons of its host.
const GRACE: Duration = Duration::from_secs(5);
/// Most host ends.
const MAX_HOSTS: usize = 64;
/// Requests of a host that are on their way at a time.
const MAX_REQUESTS: usize = 16;

/// The host ends that this daemon end serves, by name.
#[derive(Debug)]
pub(super) struct Hosts {
    hosts: Mutex<HashMap<Arc<str>, Host>>,
    max_sessions_per_host: usize,
}

#[derive(Debug)]
struct Host {
    heard: Instant,
    links: HashMap<u64, Option<Arc<Link>>>,
    num_requests: usize,
}

impl Hosts {
    pub(super) fn new(max_sessions_per_host: usize) -> Self {
        Self { hosts: Mutex::default(), max_sessions_per_host }
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<Arc<str>, Host>> {
        // A panic while it is held leaves no inconsistent state.
        self.hosts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for one more request of a host, until [`end_request`](Self::end_request); an error in words.
    pub(super) fn begin_request(&self, name: &str) -> Result<Arc<str>, String> {
        let mut hosts = self.lock();
        if !hosts.contains_key(name) {
            if hosts.len() >= MAX_HOSTS {
                return Err(format!("{MAX_HOSTS} hosts are served already"));
            }
            let host = Host { heard: Instant::now(), links: HashMap::new(), num_requests: 0 };
            hosts.insert(name.into(), host);
        }
        let (name, _) = hosts.get_key_value(name).ok_or("the host is not known")?;
        let name = Arc::clone(name);
        let host = hosts.get_mut(&name).ok_or("the host is not known")?;
        if host.num_requests >= MAX_REQUESTS {
            return Err(format!("{MAX_REQUESTS} requests of this host are in work already"));
        }
        host.num_requests += 1;
        Ok(name)
    }

    pub(super) fn end_request(&self, name: &str) {
        if let Some(host) = self.lock().get_mut(name) {
            host.num_requests = host.num_requests.saturating_sub(1);
        }
    }

    /// A place for one more link of a host; an error in words.
    pub(super) fn begin_link(&self, name: &str, link: u64) -> Result<(), String> {
        let mut hosts = self.lock();
        let host = hosts.get_mut(name).ok_or("the host is not known")?;
        if host.links.contains_key(&link) {
            return Err("this registration came before".to_owned());
        }
        if host.links.len() >= self.max_sessions_per_host {
            return Err(format!("{} sessions of this host are open already", self.max_sessions_per_host));
        }
        host.links.insert(link, None);
        Ok(())
    }

    /// The link is open, or was refused.
    pub(super) fn finish_link(&self, name: &str, link: u64, opened: Option<Arc<Link>>) {
        if let Some(host) = self.lock().get_mut(name) {
            match opened {
                Some(opened) => drop(host.links.insert(link, Some(opened))),
                None => drop(host.links.remove(&link)),
            }
        }
    }

    /// A link of a host.
    pub(super) fn link(&self, name: &str, link: u64) -> Option<Arc<Link>> {
        self.lock().get(name)?.links.get(&link)?.clone()
    }

    /// A beacon of a host has come. Links that it does not have any more end.
    pub(super) fn hear(&self, name: &str, beacon: &HostBeacon) {
        let mut hosts = self.lock();
        let Some(host) = hosts.get_mut(name) else { return };
        host.heard = Instant::now();
        host.links.retain(|link, open| {
            let Some(open) = open else { return true };
            let stays = beacon.links.contains(link) || open.opened.elapsed() < GRACE;
            if !stays {
                open.end();
            }
            stays && !open.has_ended()
        });
    }

    /// Ends the links of hosts that have left; gives back their names.
    pub(super) fn end_left(&self) -> Vec<Arc<str>> {
        let mut left = Vec::new();
        self.lock().retain(|name, host| {
            let stays = host.heard.elapsed() < LEFT_AFTER || host.num_requests > 0;
            if !stays {
                host.links.values().flatten().for_each(|link| link.end());
                left.push(Arc::clone(name));
            }
            stays
        });
        left
    }

    /// Ends all links, as the daemon is gone.
    pub(super) fn end_all(&self) {
        for host in self.lock().values_mut() {
            host.links.drain().filter_map(|(_, link)| link).for_each(|link| link.end());
        }
    }

    /// Names, links and seconds of silence.
    pub(super) fn list(&self) -> Vec<(Arc<str>, usize, f64)> {
        let hosts = self.lock();
        hosts
            .iter()
            .map(|(name, host)| (Arc::clone(name), host.links.len(), host.heard.elapsed().as_secs_f64()))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_limit_requests_and_links_of_each_and_refuse_a_registration_that_came_before() {
        let hosts = Hosts::new(2);
        assert!(hosts.begin_link("a", 1).is_err(), "a host that asked for nothing");
        for _ in 0..MAX_REQUESTS {
            hosts.begin_request("a").unwrap();
        }
        assert!(hosts.begin_request("a").unwrap_err().contains("16 requests"));
        hosts.begin_request("b").unwrap();
        hosts.end_request("a");
        hosts.begin_request("a").unwrap();
        hosts.begin_link("a", 1).unwrap();
        assert!(hosts.begin_link("a", 1).unwrap_err().contains("came before"));
        hosts.begin_link("a", 2).unwrap();
        assert!(hosts.begin_link("a", 3).unwrap_err().contains("2 sessions"));
        hosts.finish_link("a", 2, None);
        hosts.begin_link("a", 3).unwrap();
        assert!(hosts.link("a", 3).is_none(), "it is not open yet");
        for k in 2..MAX_HOSTS {
            hosts.begin_request(&format!("host-{k}")).unwrap();
        }
        assert!(hosts.begin_request("one-more").unwrap_err().contains("64 hosts"));
        assert!(hosts.end_left().is_empty());
    }
}
