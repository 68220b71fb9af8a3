//! What iceoryx2 0.10 leaves behind the dead for good.
//!
//! Its cleaning of a dead node goes by the node's tags. A process that was killed between making a file and noting it, or in the middle of
//! making a tag, leaves what no tag names, or a tag that can't be read and keeps its node from going. Each is small, but nobody else
//! would ever remove it while this daemon runs.

use std::{
    collections::{HashMap, HashSet},
    io::Result,
    path::{Path, PathBuf},
};

use iceoryx2::prelude::{CallbackProgression, Config, Node, NodeState};
use untangled_transport::{Domain, memory::{self, ProcessId}, services::Ipc};

/// Sweeps in which something must look left before it goes: by then the dead have been cleaned up behind several times.
const SWEEPS: u32 = 5;

/// What looked left in the last sweeps, and in how many of them.
#[derive(Debug, Default)]
pub(super) struct Leftovers(HashMap<PathBuf, u32>);

impl Leftovers {
    /// Whether nothing looked left in the last sweep.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Removes what has looked left in [`SWEEPS`] sweeps; returns how many files and folders.
    ///
    /// Something is left if its name carries the id of a process that is gone, and no living node has that id. The second protects
    /// processes whose ids can't be seen from here.
    pub(super) fn sweep(&mut self, domain: &Domain, config: &Config) -> Result<usize> {
        // Files first: whoever makes one has made its node before.
        let orphans = orphans(domain)?;
        let living = if orphans.is_empty() { HashSet::new() } else { living_processes(config)? };
        let is_left = |processes: &[ProcessId]| processes.iter().any(|process| !living.contains(process));
        let left = orphans.into_iter().filter(|(_, gone)| is_left(gone)).map(|(path, _)| path);
        self.0 = left.map(|path| (path.clone(), self.0.get(&path).map_or(1, |num_sweeps| num_sweeps + 1))).collect();
        let mut removed = 0;
        for path in self.0.iter().filter(|&(_, &num_sweeps)| num_sweeps >= SWEEPS).map(|(path, _)| path) {
            let result = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
            removed += usize::from(result.is_ok());
        }
        Ok(removed)
    }
}

/// Files and folders of the domain whose names carry ids of processes that are gone, with those ids.
fn orphans(domain: &Domain) -> Result<Vec<(PathBuf, Vec<ProcessId>)>> {
    let nodes = domain.root().join("nodes");
    let mut orphans = Vec::new();
    for (folder, is_ours) in [(Path::new(memory::FOLDER), false), (domain.root(), true), (&nodes, true)] {
        if !folder.is_dir() {
            continue;
        }
        for entry in std::fs::read_dir(folder)?.flatten() {
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            // The folder of a node has its id alone for a name.
            let Some(name) = name.strip_prefix(domain.prefix()).or(is_ours.then_some(name)) else { continue };
            // A service outlives whoever made it while others use it.
            if name.ends_with(".dynamic") {
                continue;
            }
            let gone: Vec<ProcessId> = memory::processes(name).filter(|process| process.is_gone()).collect();
            if !gone.is_empty() {
                orphans.push((entry.path(), gone));
            }
        }
    }
    Ok(orphans)
}

/// The processes of all nodes that are not known to be dead.
fn living_processes(config: &Config) -> Result<HashSet<ProcessId>> {
    let mut living = HashSet::new();
    Node::<Ipc>::list(config, |node| {
        if !matches!(node, NodeState::Dead(_)) {
            living.extend(ProcessId::of(node.node_id().value()));
        }
        CallbackProgression::Continue
    })
    .map_err(|error| std::io::Error::other(format!("listing nodes: {error:?}")))?;
    Ok(living)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use iceoryx2::prelude::{NodeBuilder, SignalHandlingMode};
    use untangled_transport::lock::WipeOnLeave;

    use super::*;

    #[test]
    fn what_the_dead_left_goes_and_what_the_living_have_stays() {
        let base = std::env::temp_dir().join(format!("left-{}", std::process::id()));
        let domain = Domain::new("left", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        domain.create_folders().unwrap();
        let config = domain.config().unwrap();
        let node =
            NodeBuilder::new().config(&config).signal_handling_mode(SignalHandlingMode::Disabled).create::<Ipc>();
        let node = node.unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let dead = (u128::from(child.id()) << 64) | 7;
        child.wait().unwrap();
        let living = node.id().value();
        let segment = |name: &str| Path::new(memory::FOLDER).join(format!("{}{name}", domain.prefix()));
        let nodes = domain.root().join("nodes");
        let (left, kept) = (
            [
                segment(&format!("ab_{dead}.event_mgmt")),
                segment(&format!("ab_{dead}_{living}.connection")),
                nodes.join(format!("{}{dead}.node_monitor", domain.prefix())),
                domain.root().join(format!("{}{dead}.event", domain.prefix())),
            ],
            [segment(&format!("ab_{living}.event_mgmt")), segment(&format!("ab_{dead}.dynamic"))],
        );
        left.iter().chain(&kept).for_each(|path| fs::write(path, "").unwrap());
        let folder = nodes.join(dead.to_string());
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("some.port_tag"), "").unwrap();
        let mut leftovers = Leftovers::default();
        let removed: Vec<usize> = (0..=SWEEPS).map(|_| leftovers.sweep(&domain, &config).unwrap()).collect();
        let exist = |paths: &[PathBuf]| paths.iter().filter(|path| path.exists()).count();
        let counts = (exist(&left), folder.exists(), exist(&kept));
        drop(node);
        // The shared memory of the node too, and what was kept.
        drop(WipeOnLeave(domain.clone()));
        let _ = fs::remove_dir_all(&base);
        assert_eq!(removed, [0, 0, 0, 0, 5, 0]);
        assert_eq!(counts, (0, false, 2));
        assert!(leftovers.0.is_empty(), "what is gone is forgotten");
    }
}
