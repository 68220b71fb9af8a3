//! An analysis in a form that depends on neither numbering nor place, to compare analyses of the same cloth.

use std::collections::BTreeSet;

use untangle::{analysis::Analysis, mesh::Mesh, paths::PairType};

/// Everything that a relabelling or a rigid motion must not change, in old names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Edges, by their ends in ascending order, with the faces that they pierce.
    pub edge_face: BTreeSet<([u32; 2], u32)>,
    /// Faces that intersect, each pair in ascending order.
    pub face_pairs: BTreeSet<[u32; 2]>,
    /// Pairs of paths, sorted.
    pub pairs: Vec<PairSummary>,
}

/// One pair of paths.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PairSummary {
    /// Type of the pair.
    pub pair_type: PairType,
    /// Segments of one of its paths.
    pub num_segments: usize,
    /// Loop vertices.
    pub loop_vertices: BTreeSet<u32>,
    /// Vertices inside, one set for each path, sorted.
    pub inside: Vec<BTreeSet<u32>>,
}

/// The summary of an analysis whose vertices and faces have these old names.
pub fn summary(mesh: &Mesh, analysis: &Analysis, vertex: impl Fn(u32) -> u32, face: impl Fn(u32) -> u32) -> Summary {
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
