//! What an analysis says, in a form that doesn't depend on numbering or place: to compare analyses of the same cloth.

use std::collections::BTreeSet;

use untangle::{analysis::Analysis, mesh::Mesh, paths::PairType};

/// Everything that a relabelling or a motion leaves alone, in old names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Summary {
    pub(crate) edge_face: BTreeSet<([u32; 2], u32)>,
    pub(crate) face_pairs: BTreeSet<[u32; 2]>,
    /// Sorted.
    pub(crate) pairs: Vec<PairSummary>,
}

/// One pair of paths.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PairSummary {
    pub(crate) pair_type: PairType,
    pub(crate) num_segments: usize,
    pub(crate) loop_vertices: BTreeSet<u32>,
    /// One set for each copy, sorted.
    pub(crate) inside: Vec<BTreeSet<u32>>,
}

/// The summary of an analysis whose vertices and faces have these old names.
pub(crate) fn summary(
    mesh: &Mesh,
    analysis: &Analysis,
    vertex: impl Fn(u32) -> u32,
    face: impl Fn(u32) -> u32,
) -> Summary {
    let Analysis { intersections, paths, regions } = analysis;
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut pairs: Vec<_> = paths
        .pairs
        .iter()
        .map(|pair| {
            let mut inside: Vec<BTreeSet<u32>> = pair
                .copies
                .clone()
                .map(|copy| regions.vertices_of(copy).iter().map(|id| vertex(id.0)).collect())
                .collect();
            inside.sort();
            let loop_vertices = pair.loop_vertices.iter().map(|id| vertex(id.0)).collect();
            PairSummary { pair_type: pair.pair_type, num_segments: pair.num_segments, loop_vertices, inside }
        })
        .collect();
    pairs.sort();
    Summary {
        edge_face: intersections
            .edge_face
            .iter()
            .map(|hit| (sorted(mesh.edge(hit.edge).map(|end| vertex(end.0))), face(hit.face.0)))
            .collect(),
        face_pairs: intersections.segments.iter().map(|segment| sorted(segment.faces.map(|id| face(id.0)))).collect(),
        pairs,
    }
}
