//! Change detection: an idle daemon does not clean up; it only checks two folders' times and whether known processes
//! live.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use crate::{
    Domain, memory,
    process_id::{self, ProcessId},
};

/// How long ago a folder must have changed before its time is trusted: a file that is created right after the check can
/// leave the folder with the same time.
const SETTLED: Duration = Duration::from_secs(2);

/// Longest time without a cleanup. A process of another namespace may look alive because another process here has its
/// id.
const LONGEST: Duration = Duration::from_secs(10);

/// The state of the domain's folders when they last changed.
#[derive(Debug)]
pub(crate) struct ChangeDetector {
    nodes: PathBuf,
    prefix: String,
    memory: &'static Path,
    changed: Option<[SystemTime; 2]>,
    processes: Vec<ProcessId>,
    since: Instant,
}

impl ChangeDetector {
    pub(crate) fn new(domain: &Domain) -> Self {
        Self {
            nodes: domain.root().join("nodes"),
            prefix: domain.prefix().to_owned(),
            memory: Path::new(memory::FOLDER),
            changed: None,
            processes: Vec::new(),
            since: Instant::now(),
        }
    }

    /// Whether the folders have not changed for a while and all processes that have a node are alive. The answer is no
    /// where a folder can't be read, and at least once in [`LONGEST`].
    ///
    /// Cost: two system calls for the folders, and one for each process.
    pub(crate) fn is_unchanged(&mut self) -> bool {
        let is_unchanged = self.folders_and_processes_are_same() && self.since.elapsed() < LONGEST;
        if !is_unchanged {
            self.since = Instant::now();
        }
        is_unchanged
    }

    fn folders_and_processes_are_same(&mut self) -> bool {
        let Some(changed) = changed(&self.nodes).zip(changed(self.memory)).map(<[SystemTime; 2]>::from) else {
            return false;
        };
        if self.changed == Some(changed) {
            return !self.processes.iter().any(|process| process.is_gone());
        }
        let settled = changed.iter().all(|time| time.elapsed().is_ok_and(|since| since > SETTLED));
        if let Some(processes) = processes(&self.nodes, &self.prefix) {
            self.processes = processes;
            self.changed = settled.then_some(changed);
        }
        false
    }
}

fn changed(folder: &Path) -> Option<SystemTime> {
    std::fs::metadata(folder).and_then(|metadata| metadata.modified()).ok()
}

/// The processes that the names of nodes carry, each once.
fn processes(nodes: &Path, prefix: &str) -> Option<Vec<ProcessId>> {
    let mut processes = Vec::new();
    for entry in std::fs::read_dir(nodes).ok()?.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        for process in process_id::in_name(name.strip_prefix(prefix).unwrap_or(name)) {
            if !processes.contains(&process) {
                processes.push(process);
            }
        }
    }
    Some(processes)
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};

    use super::*;

    #[test]
    fn detector_reports_changed_folders_and_dead_processes() {
        let base = std::env::temp_dir().join(format!("changes-{}", std::process::id()));
        let domain = Domain::new("changes", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        let nodes = domain.root().join("nodes");
        fs::create_dir_all(&nodes).unwrap();
        let mut child = std::process::Command::new("sleep").arg("1000").spawn().unwrap();
        fs::create_dir(nodes.join(((u128::from(child.id()) << 64) | 7).to_string())).unwrap();
        // Other processes change the folder of shared memory at any time: /usr stands for it.
        let mut detector = ChangeDetector { memory: Path::new("/usr"), ..ChangeDetector::new(&domain) };
        let age = |by: u32| File::open(&nodes).unwrap().set_modified(SystemTime::now() - by * SETTLED).unwrap();
        let at_once = [detector.is_unchanged(), detector.is_unchanged()];
        age(2);
        let settled = [detector.is_unchanged(), detector.is_unchanged()];
        age(3);
        let changed = [detector.is_unchanged(), detector.is_unchanged()];
        detector.since -= LONGEST;
        let too_long = [detector.is_unchanged(), detector.is_unchanged()];
        child.kill().unwrap();
        child.wait().unwrap();
        let dead = detector.is_unchanged();
        fs::remove_dir_all(&base).unwrap();
        assert_eq!((at_once, dead, detector.is_unchanged()), ([false; 2], false, false));
        assert_eq!([settled, changed, too_long], [[false, true]; 3]);
    }
}
