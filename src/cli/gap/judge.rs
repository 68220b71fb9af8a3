//! Pairs below the gap in a file, by the judge.

use serde::Serialize;

use untangled_checker::{NearPairs, near_pairs};
use untangled_mesh_io::MeshFile;

use crate::cli::{certificate::single, input::Input, roles::Roles};

/// Pairs of primitives that are nearer than asked for, by a judge that shares no code with the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct GapCertificate {
    /// In double precision.
    pub num_pairs_below: usize,
    /// With positions rounded to single precision; nothing where they are beyond it.
    pub num_pairs_below_single: Option<usize>,
}

impl GapCertificate {
    /// Judges the world of `files` and bodies, whose welded vertices are one.
    pub(in crate::cli) fn of(files: &[MeshFile], roles: &Roles, input: &Input, distance_m: f64) -> Self {
        let positions = input.weld.gather(&input.positions);
        let (mut triangles, mut first) = (Vec::new(), 0);
        for file in files.iter().chain(&roles.bodies) {
            triangles.extend(file.faces().iter().map(|face| face.map(|vertex| input.weld.of(vertex + first).0)));
            first += u32::try_from(file.positions().len()).unwrap_or(u32::MAX);
        }
        let first_body = files.iter().map(|file| file.faces().len()).sum();
        let rounded: Vec<[f64; 3]> = positions.iter().map(|position| position.map(single)).collect();
        let near = |positions: &[[f64; 3]]| near_pairs(positions, &triangles, first_body, distance_m);
        Self {
            num_pairs_below: near(&positions).as_ref().map_or(0, NearPairs::total),
            num_pairs_below_single: near(&rounded).ok().map(|found| found.total()),
        }
    }

    /// Whether no reader finds a pair.
    pub(in crate::cli) fn is_kept(self) -> bool {
        self.total() == 0
    }

    /// The pairs of all readers together, to compare two states by.
    pub(in crate::cli) fn total(self) -> usize {
        self.num_pairs_below + self.num_pairs_below_single.unwrap_or(0)
    }
}
