//! Stale resources: files of crashed peers that iceoryx2 0.10 never removes.
//!
//! iceoryx2 cleans up a dead node by the node's tags. A process that was killed between creating a file and noting it
//! in a tag leaves a file that no tag names; one that was killed while it wrote a tag leaves a tag that can't be read,
//! and the node stays. One that was killed while it removed a service that nobody else used leaves a service without
//! users. Each such file is small, but nothing else would remove it while this daemon runs.

use std::{
    collections::{HashMap, HashSet},
    io::Result,
    path::{Path, PathBuf},
};

use iceoryx2::prelude::Config;

use crate::{
    Domain, memory, node,
    process_id::{self, ProcessId},
};

/// Sweeps in which a file must look stale before it is removed: by then dead nodes have been cleaned up several times.
const SWEEPS: u32 = 5;

/// Files and folders that looked stale in the last sweeps, and in how many sweeps in a row.
#[derive(Debug, Default)]
pub(crate) struct StaleResources(HashMap<PathBuf, u32>);

impl StaleResources {
    /// Whether nothing looked stale in the last sweep.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Removes files and folders that have looked stale in [`SWEEPS`] sweeps in a row; returns their number.
    ///
    /// A file looks stale if its name carries the id of a process that is gone, and no living node has that id, or if
    /// it belongs to a service that no node uses. The second condition protects processes of other namespaces, whose
    /// ids can't be seen from here.
    pub(crate) fn sweep(&mut self, domain: &Domain, config: &Config) -> Result<usize> {
        // Files are listed before nodes: a process creates its node before any of its files.
        let orphans = orphans(domain)?;
        let living = if orphans.is_empty() { HashSet::new() } else { living_processes(config)? };
        let is_stale = |processes: &[ProcessId]| processes.iter().any(|process| !living.contains(process));
        let stale = orphans.into_iter().filter(|(_, gone)| is_stale(gone)).map(|(path, _)| path);
        let stale = stale.chain(files_of_unused_services(domain, config)?);
        self.0 = stale.map(|path| (path.clone(), self.0.get(&path).map_or(1, |num_sweeps| num_sweeps + 1))).collect();
        let mut due: Vec<&PathBuf> =
            self.0.iter().filter(|&(_, &count)| count >= SWEEPS).map(|(path, _)| path).collect();
        // The description of a service names its other file, and has to go last.
        due.sort_by_key(|path| path.starts_with(services_folder(domain)));
        let mut removed = 0;
        for path in due {
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
            // The folder of a node has the node's id for a name, without the prefix.
            let Some(name) = name.strip_prefix(domain.prefix()).or(is_ours.then_some(name)) else { continue };
            // A service outlives the process that created it while others use it.
            if name.ends_with(".dynamic") {
                continue;
            }
            let gone: Vec<ProcessId> = process_id::in_name(name).filter(|process| process.is_gone()).collect();
            if !gone.is_empty() {
                orphans.push((entry.path(), gone));
            }
        }
    }
    Ok(orphans)
}

fn services_folder(domain: &Domain) -> PathBuf {
    domain.root().join("services")
}

/// The files of services that no node uses.
fn files_of_unused_services(domain: &Domain, config: &Config) -> Result<Vec<PathBuf>> {
    let services =
        node::unused_services(config).map_err(|error| std::io::Error::other(format!("listing services: {error:?}")))?;
    if services.is_empty() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(memory::FOLDER)?.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|name| name.starts_with(domain.prefix())) else { continue };
        if services.iter().any(|service| name.ends_with(&service.users_file_end)) {
            files.push(entry.path());
        }
    }
    let folder = services_folder(domain);
    files
        .extend(services.iter().map(|service| folder.join(format!("{}{}", domain.prefix(), service.description_file))));
    Ok(files)
}

/// The processes of all nodes that are not known to be dead.
fn living_processes(config: &Config) -> Result<HashSet<ProcessId>> {
    let ids = node::living(config).map_err(|error| std::io::Error::other(format!("listing nodes: {error:?}")))?;
    Ok(ids.into_iter().filter_map(ProcessId::of).collect())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use iceoryx2::prelude::SignalHandlingMode;

    use crate::{lock::WipeOnLeave, services};

    use super::*;

    #[test]
    fn sweep_removes_files_of_dead_processes_and_keeps_those_of_living_ones() {
        let base = std::env::temp_dir().join(format!("stale-{}", std::process::id()));
        let domain = Domain::new("stale", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        domain.create_folders().unwrap();
        let config = domain.config().unwrap();
        let node = node::create(&config, SignalHandlingMode::Disabled).unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        let dead = (u128::from(child.id()) << 64) | 7;
        child.wait().unwrap();
        let living = node.id().value();
        let segment = |name: &str| Path::new(memory::FOLDER).join(format!("{}{name}", domain.prefix()));
        let nodes = domain.root().join("nodes");
        let (dead_files, living_files) = (
            [
                segment(&format!("ab_{dead}.event_mgmt")),
                segment(&format!("ab_{dead}_{living}.connection")),
                nodes.join(format!("{}{dead}.node_monitor", domain.prefix())),
                domain.root().join(format!("{}{dead}.event", domain.prefix())),
            ],
            [segment(&format!("ab_{living}.event_mgmt")), segment(&format!("ab_{dead}.dynamic"))],
        );
        dead_files.iter().chain(&living_files).for_each(|path| fs::write(path, "").unwrap());
        let folder = nodes.join(dead.to_string());
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("some.port_tag"), "").unwrap();
        let mut stale = StaleResources::default();
        let removed: Vec<usize> = (0..=SWEEPS).map(|_| stale.sweep(&domain, &config).unwrap()).collect();
        let exist = |paths: &[PathBuf]| paths.iter().filter(|path| path.exists()).count();
        let counts = (exist(&dead_files), folder.exists(), exist(&living_files));
        drop(node);
        // Removes the shared memory of the node, and the files that the sweeps kept.
        drop(WipeOnLeave(domain.clone()));
        let _ = fs::remove_dir_all(&base);
        assert_eq!(removed, [0, 0, 0, 0, 5, 0]);
        assert_eq!(counts, (0, false, 2));
        assert!(stale.0.is_empty(), "removed files are no longer listed");
    }

    #[test]
    fn sweep_removes_services_that_no_node_uses_and_keeps_those_in_use() {
        let base = std::env::temp_dir().join(format!("unused-{}", std::process::id()));
        let domain = Domain::new("unused", Some(&base), rustix::process::getuid().as_raw()).unwrap();
        domain.create_folders().unwrap();
        let config = domain.config().unwrap();
        let node = node::create(&config, SignalHandlingMode::Disabled).unwrap();
        let files = || -> Vec<PathBuf> {
            let memory = fs::read_dir(memory::FOLDER).unwrap().flatten().map(|entry| entry.path());
            let memory = memory.filter(|path| {
                let name = path.file_name().unwrap().to_str().unwrap();
                name.starts_with(domain.prefix()) && name.ends_with(".dynamic")
            });
            memory.chain(fs::read_dir(services_folder(&domain)).unwrap().flatten().map(|entry| entry.path())).collect()
        };
        let in_use = services::create_session_event(&node, "in use").unwrap();
        let kept = files();
        // A process that is killed while it removes a service leaves both of its files or the description.
        let mut left = Vec::new();
        let leaver = node::create(&config, SignalHandlingMode::Disabled).unwrap();
        for (name, num_left) in [("both", 2), ("description", 1)] {
            let service = services::create_session_event(&leaver, name).unwrap();
            let mut of_service: Vec<_> = files().into_iter().filter(|path| !kept.contains(path)).collect();
            assert_eq!(of_service.len(), 2);
            of_service.sort_by_key(|path| !path.starts_with(services_folder(&domain)));
            let saved: Vec<_> = of_service
                .into_iter()
                .map(|path| (path.clone(), fs::read(&path).unwrap(), fs::metadata(&path).unwrap()))
                .collect();
            drop(service);
            left.extend(saved.into_iter().take(num_left));
        }
        drop(leaver);
        left.iter().for_each(|(path, bytes, metadata)| {
            fs::write(path, bytes).unwrap();
            fs::set_permissions(path, metadata.permissions()).unwrap();
        });
        let mut stale = StaleResources::default();
        let removed: Vec<usize> = (0..=SWEEPS).map(|_| stale.sweep(&domain, &config).unwrap()).collect();
        let after = files();
        drop((in_use, node));
        drop(WipeOnLeave(domain.clone()));
        let _ = fs::remove_dir_all(&base);
        assert_eq!(removed, [0, 0, 0, 0, 3, 0]);
        assert_eq!(after, kept);
    }
}
