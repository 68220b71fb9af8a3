//! Everything that reads bytes from outside, as functions of these bytes: for a fuzzer that coverage guides, and for
//! the tests of what it found.
//!
//! Each function says whether the input was accepted, and panics where an invariant does not hold. What is accepted
//! holds what `checks` say; a refusal is one line that a terminal may show, and says where the fault is.

mod caches;
mod clouds;
mod files;
mod messages;
mod relaxation;
mod requests;
mod scratch;
mod seeds;
mod states;

pub(super) use files::{mesh_file, usd};

/// A reader of bytes.
#[derive(Clone, Copy, Debug)]
pub struct ByteTarget {
    /// What `fuzz/run` calls it.
    pub name: &'static str,
    /// Reads bytes; whether they were accepted.
    pub read: fn(&[u8]) -> bool,
    /// Inputs to begin with, many of which are accepted.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them, but for those of the bridge.
pub const TARGETS: [ByteTarget; 14] = [
    ByteTarget { name: "obj", read: files::obj, seeds: seeds::obj },
    ByteTarget { name: "ply", read: files::ply, seeds: seeds::ply },
    ByteTarget { name: "stl", read: files::stl, seeds: seeds::stl },
    ByteTarget { name: "gltf", read: files::gltf, seeds: seeds::gltf },
    ByteTarget { name: "pc2", read: caches::pc2, seeds: seeds::pc2 },
    ByteTarget { name: "mdd", read: caches::mdd, seeds: seeds::mdd },
    ByteTarget { name: "usd", read: files::usd, seeds: seeds::usd },
    ByteTarget { name: "registration", read: requests::registration, seeds: seeds::registrations },
    ByteTarget { name: "settings", read: requests::settings, seeds: seeds::settings },
    ByteTarget { name: "state", read: states::state, seeds: seeds::clouds },
    ByteTarget { name: "correction", read: messages::correction, seeds: seeds::corrections },
    ByteTarget { name: "paths", read: messages::paths, seeds: seeds::paths },
    ByteTarget { name: "view", read: messages::view, seeds: seeds::views },
    ByteTarget { name: "relax", read: relaxation::relax_cloud, seeds: seeds::clouds },
];

/// Reads bytes as the target of a name does.
///
/// # Panics
/// Where an invariant does not hold, or there is no such target.
pub fn read(name: &str, bytes: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.unwrap_or_else(|| panic!("there is no target {name}")).read)(bytes)
}
