//! The daemon ends that this host end hears of, and the choice among them.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};
use untangled_transport::throttle::Throttle;

use super::session::Remote;
use crate::{net::LOST_AFTER, wire::beacon::DaemonBeacon};

/// Most daemon ends that are remembered.
const MAX_DAEMONS: usize = 256;
/// A beacon counts a session that was registered so long before it comes.
const COUNTED_AFTER: Duration = Duration::from_millis(500);

/// The daemon ends that this host end hears of, by name.
#[derive(Debug, Default)]
pub(crate) struct Directory(Mutex<BTreeMap<Arc<str>, Known>>);

#[derive(Debug)]
struct Known {
    beacon: DaemonBeacon,
    heard: Instant,
    /// Triangles that were registered there, and when: a beacon of about that time may not count them yet.
    added_faces: Vec<(Instant, u64)>,
}

impl Known {
    fn is_there(&self, now: Instant) -> bool {
        now.duration_since(self.heard) < LOST_AFTER
    }

    fn serves(&self, now: Instant) -> bool {
        self.is_there(now) && self.beacon.instance != 0
    }

    fn load(&self) -> u64 {
        self.beacon.load(self.added_faces.iter().map(|(_, faces)| faces).sum())
    }

    fn runs(&self) -> [u64; 2] {
        [self.beacon.run, self.beacon.instance]
    }
}

/// A daemon end, for a report.
#[derive(Clone, Debug)]
pub(crate) struct Listed {
    pub(crate) name: Arc<str>,
    pub(crate) serves: bool,
    pub(crate) silent_s: f64,
    pub(crate) beacon: DaemonBeacon,
}

impl Directory {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<Arc<str>, Known>> {
        // A panic while it is held leaves no inconsistent state.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A beacon has come.
    pub(crate) fn hear(&self, name: &str, beacon: DaemonBeacon) {
        if let Some(reason) = beacon.versions.refusal() {
            static REFUSED: Throttle = Throttle::new();
            if let Some(num_suppressed) = REFUSED.admit() {
                tracing::warn!(daemon = name, %reason, num_suppressed, "a daemon end can't be used");
            }
            return;
        }
        let now = Instant::now();
        let mut daemons = self.lock();
        if let Some(known) = daemons.get_mut(name) {
            let was = known.serves(now);
            known.added_faces.retain(|(added, _)| now.duration_since(*added) < COUNTED_AFTER);
            (known.beacon, known.heard) = (beacon, now);
            let serves = known.serves(now);
            drop(daemons);
            if was != serves {
                log_change(name, serves);
            }
            return;
        }
        daemons.retain(|_, known| known.is_there(now));
        if daemons.len() < MAX_DAEMONS {
            let known = Known { beacon, heard: now, added_faces: Vec::new() };
            let serves = known.serves(now);
            daemons.insert(name.into(), known);
            drop(daemons);
            log_change(name, serves);
        }
    }

    /// The daemon with the fewest triangles for each worker, but those in `tried`; the first by name of equal ones.
    pub(crate) fn choose(&self, tried: &[Arc<str>]) -> Option<(Arc<str>, [u64; 2])> {
        let now = Instant::now();
        let daemons = self.lock();
        let usable = daemons.iter().filter(|(name, known)| known.serves(now) && !tried.contains(name));
        let (name, known) = usable.min_by_key(|(_, known)| known.load())?;
        Some((Arc::clone(name), known.runs()))
    }

    /// A session of so many triangles goes to a daemon, which does not say so before its next beacon.
    pub(crate) fn add_faces(&self, name: &str, num_faces: u64) {
        if let Some(known) = self.lock().get_mut(name) {
            known.added_faces.push((Instant::now(), num_faces));
        }
    }

    /// A daemon end has answered that there is no daemon: its next beacon may say otherwise.
    pub(crate) fn has_no_daemon(&self, name: &str) {
        if let Some(known) = self.lock().get_mut(name) {
            known.beacon.instance = 0;
        }
    }

    /// Whether the daemon of a session still runs, as far as is known.
    pub(crate) fn has(&self, remote: &Remote) -> bool {
        let now = Instant::now();
        self.lock().get(&remote.daemon).is_some_and(|known| known.is_there(now) && known.runs() == remote.runs)
    }

    /// Whether a daemon serves anywhere.
    pub(crate) fn has_any(&self) -> bool {
        self.choose(&[]).is_some()
    }

    /// The daemon ends that are there.
    pub(crate) fn list(&self) -> Vec<Listed> {
        let now = Instant::now();
        let daemons = self.lock();
        let listed = daemons.iter().map(|(name, known)| Listed {
            name: Arc::clone(name),
            serves: known.serves(now),
            silent_s: now.duration_since(known.heard).as_secs_f64(),
            beacon: known.beacon.clone(),
        });
        listed.collect()
    }

    /// Names of the daemon ends that are there.
    pub(crate) fn names(&self) -> Vec<Arc<str>> {
        let now = Instant::now();
        self.lock().iter().filter(|(_, known)| known.is_there(now)).map(|(name, _)| Arc::clone(name)).collect()
    }
}

fn log_change(name: &str, serves: bool) {
    static CHANGED: Throttle = Throttle::new();
    if let Some(num_suppressed) = CHANGED.admit() {
        let words = if serves { "a daemon serves" } else { "a daemon end has no daemon" };
        tracing::info!(daemon = name, num_suppressed, "{words}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::beacon::Versions;

    fn beacon(instance: u64, num_faces: u64) -> DaemonBeacon {
        DaemonBeacon { versions: Versions::own(), run: 1, instance, num_faces, num_workers: 2 }
    }

    #[test]
    fn choose_takes_the_least_loaded_daemon_that_serves_and_counts_what_was_registered_since() {
        let directory = Directory::default();
        assert!(!directory.has_any());
        directory.hear("a", beacon(5, 1000));
        directory.hear("b", beacon(6, 400));
        directory.hear("c", beacon(0, 0));
        let chosen = |tried: &[Arc<str>]| directory.choose(tried).map(|(name, _)| name.to_string());
        assert_eq!(chosen(&[]).as_deref(), Some("b"));
        directory.add_faces("b", 1000);
        assert_eq!(chosen(&[]).as_deref(), Some("a"));
        assert_eq!(chosen(&["a".into()]).as_deref(), Some("b"));
        // A beacon that was on its way meanwhile does not count it yet; one that comes later does.
        directory.hear("b", beacon(6, 400));
        assert_eq!(chosen(&[]).as_deref(), Some("a"));
        std::thread::sleep(COUNTED_AFTER);
        directory.hear("a", beacon(5, 1000));
        directory.hear("b", beacon(6, 800));
        assert_eq!(chosen(&[]).as_deref(), Some("b"));
        let remote = |runs| Remote { daemon: "b".into(), runs, session: 1 };
        assert!(directory.has(&remote([1, 6])) && !directory.has(&remote([1, 7])) && !directory.has(&remote([2, 6])));
        directory.has_no_daemon("b");
        assert_eq!(chosen(&["a".into()]), None);
        let other = DaemonBeacon { versions: Versions { bridge: 9, ..Versions::own() }, ..beacon(9, 0) };
        directory.hear("d", other);
        assert_eq!(directory.names().len(), 3, "an end of another version is not used");
    }
}
