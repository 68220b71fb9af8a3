//! Where pairs could not be set apart.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use untangle::{mesh::VertexId, relax::InfeasiblePlace, weld::Weld};

use super::side::Side;
use crate::cli::{owners::Owners, wording::Counted};

/// Pairs of primitives that stayed nearer than the gap, in one place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InfeasibleReport {
    /// Their vertices, counted from 0 over all files; of welded ones the lowest.
    pub vertices: Vec<u32>,
    /// To whom they belong: a file and an object or group, each with its vertices.
    pub owners: Vec<Side>,
    /// How many pairs there are.
    pub num_pairs: usize,
    /// The least distance of them, in metres.
    pub distance_m: f64,
    /// Why they could not be set apart, in words.
    pub reason: String,
}

impl InfeasibleReport {
    pub(in crate::cli) fn new(place: &InfeasiblePlace, weld: &Weld, owners: &Owners<'_>) -> Self {
        let mut vertices: Vec<u32> = place.vertices.iter().map(|&vertex| weld.first(VertexId(vertex))).collect();
        vertices.sort_unstable();
        let mut sides: Vec<Side> = Vec::new();
        for (&vertex, owner) in vertices.iter().zip(owners.of_vertices(vertices.iter().copied())) {
            let Some(owner) = owner else { continue };
            let at = sides.iter().position(|side| side.file == owner.file && side.part == owner.part);
            let at = at.unwrap_or_else(|| {
                sides.push(Side { file: owner.file, part: owner.part, ..Side::default() });
                sides.len() - 1
            });
            sides[at].vertices.push(vertex);
            sides[at].vertices_in_file.push(owner.vertex_in_file);
        }
        Self {
            vertices,
            owners: sides,
            num_pairs: place.num_pairs,
            distance_m: place.distance_m,
            reason: place.obstacle.to_string(),
        }
    }
}

impl Display for InfeasibleReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { owners, num_pairs, distance_m, reason, .. } = self;
        write!(f, "{} at {distance_m:e} m", Counted(*num_pairs, "pair"))?;
        for (number, Side { file, part, vertices_in_file, .. }) in owners.iter().enumerate() {
            let word = if number == 0 { " at" } else { " and" };
            let vertex = vertices_in_file.first().copied().unwrap_or_default();
            write!(f, "{word} vertex {vertex} of {file}")?;
            part.as_ref().map_or(Ok(()), |part| write!(f, ", {part}"))?;
        }
        write!(f, ": {reason}")
    }
}
