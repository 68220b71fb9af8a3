//! What an analysis says, in a form that doesn't depend on numbering or place: to compare analyses of the same cloth.

use std::collections::BTreeSet;

use untangled::{analysis::Analysis, mesh::Mesh, paths::PairType};

/// Everything that a relabelling or a motion leaves alone, in old names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Summary {
    pub(crate) edge_face: BTreeSet<([u32; 2], u32)>,
    pub(crate) face_pairs: BTreeSet<[u32; 2]>,
    /// Type, number of face pairs, loop vertices and inside sets of each pair of paths, sorted.
    pub(crate) pairs: Vec<(PairType, usize, BTreeSet<u32>, Vec<BTreeSet<u32>>)>,
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
            let loops = pair.loop_vertices.iter().map(|id| vertex(id.0)).collect();
            (pair.pair_type, pair.num_segments, loops, inside)
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
