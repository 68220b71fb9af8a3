//! Vertices split at edges, as exporters do at seams of texture coordinates.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A mesh whose vertices were split.
#[derive(Clone, Debug)]
pub struct Split {
    /// Vertices of each face.
    pub faces: Vec<[u32; 3]>,
    /// Position of each vertex in metres.
    pub positions: Vec<[f64; 3]>,
    /// The vertex that each was before, ascending.
    pub old_vertex: Vec<u32>,
}

/// Cuts a mesh at a random part of its edges: corners of a vertex stay one vertex where an edge that is not cut joins
/// them. Vertices without a face are left out.
pub fn split_at_edges(faces: &[[u32; 3]], positions: &[[f64; 3]], part: f64, seed: u64) -> Split {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut at_edge: BTreeMap<[u32; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (face, corners) in faces.iter().enumerate() {
        for k in 0..3 {
            let [i, j] = [3 * face + k, 3 * face + (k + 1) % 3];
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            let (edge, slots) = if a < b { ([a, b], [i, j]) } else { ([b, a], [j, i]) };
            at_edge.entry(edge).or_default().push(slots);
        }
    }
    let mut parent: Vec<usize> = (0..3 * faces.len()).collect();
    for slots in at_edge.values() {
        if rng.random_bool(part) {
            continue;
        }
        for pair in slots.windows(2) {
            for (&first, &second) in pair[0].iter().zip(&pair[1]) {
                let [a, b] = [first, second].map(|slot| root(&parent, slot));
                parent[a.max(b)] = a.min(b);
            }
        }
    }
    let corners = faces.as_flattened();
    let mut copies: Vec<(u32, usize)> =
        (0..corners.len()).filter(|&slot| parent[slot] == slot).map(|slot| (corners[slot], slot)).collect();
    copies.sort_unstable();
    let mut name = vec![0; corners.len()];
    for (new, &(_, slot)) in (0..).zip(&copies) {
        name[slot] = new;
    }
    Split {
        faces: (0..faces.len()).map(|face| [0, 1, 2].map(|k| name[root(&parent, 3 * face + k)])).collect(),
        positions: copies.iter().map(|&(old, _)| positions[old as usize]).collect(),
        old_vertex: copies.iter().map(|&(old, _)| old).collect(),
    }
}

fn root(parent: &[usize], mut slot: usize) -> usize {
    while parent[slot] != slot {
        slot = parent[slot];
    }
    slot
}
