//! Whether there is anything to clean up: an idle daemon only asks whether the processes it knows of are still there.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant, SystemTime},
};

use untangled_transport::{Domain, memory::{self, ProcessId}};

/// How long ago a folder must have changed: what came right after a look has the same time as what came before it.
const SETTLED: Duration = Duration::from_secs(2);

/// The longest quiet. Processes of another namespace may look alive by the id of somebody else here.
const LONGEST: Duration = Duration::from_secs(10);

/// What was seen when the domain's folders last changed.
#[derive(Debug)]
pub(super) struct Quiet {
    nodes: PathBuf,
    prefix: String,
    memory: &'static Path,
    changed: Option<[SystemTime; 2]>,
    processes: Vec<ProcessId>,
    since: Instant,
}

impl Quiet {
    pub(super) fn new(domain: &Domain) -> Self {
        Self {
            nodes: domain.root().join("nodes"),
            prefix: domain.prefix().to_owned(),
            memory: Path::new(memory::FOLDER),
            changed: None,
            processes: Vec::new(),
            since: Instant::now(),
        }
    }

    /// Whether the folders have not changed for a while and all processes that have a node are there. What can't be told is not quiet, and
    /// nothing is for longer than [`LONGEST`].
    ///
    /// Cost: two looks at folders, and one at each process.
    pub(super) fn is_quiet(&mut self) -> bool {
        let is_quiet = self.nothing_happened() && self.since.elapsed() < LONGEST;
        if !is_quiet {
            self.since = Instant::now();
        }
        is_quiet
    }

    fn nothing_happened(&mut self) -> bool {
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
        for process in memory::processes(name.strip_prefix(prefix).unwrap_or(name)) {
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
    fn deaths_and_changes_end_the_quiet() {
        let base = std::env::temp_dir().join(format!("quiet-{}", std::process::id()));
        let domain = Domain::new("quiet", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        let nodes = domain.root().join("nodes");
        fs::create_dir_all(&nodes).unwrap();
        let mut child = std::process::Command::new("sleep").arg("1000").spawn().unwrap();
        fs::create_dir(nodes.join(((u128::from(child.id()) << 64) | 7).to_string())).unwrap();
        // Others use the folder of shared memory at any time: this one stands for it.
        let mut quiet = Quiet { memory: Path::new("/usr"), ..Quiet::new(&domain) };
        let age = |by: u32| File::open(&nodes).unwrap().set_modified(SystemTime::now() - by * SETTLED).unwrap();
        let at_once = [quiet.is_quiet(), quiet.is_quiet()];
        age(2);
        let settled = [quiet.is_quiet(), quiet.is_quiet()];
        age(3);
        let changed = [quiet.is_quiet(), quiet.is_quiet()];
        quiet.since -= LONGEST;
        let too_long = [quiet.is_quiet(), quiet.is_quiet()];
        child.kill().unwrap();
        child.wait().unwrap();
        let dead = quiet.is_quiet();
        fs::remove_dir_all(&base).unwrap();
        assert_eq!((at_once, dead, quiet.is_quiet()), ([false; 2], false, false));
        assert_eq!([settled, changed, too_long], [[false, true]; 3]);
    }
}
