//! Intersection paths as `check` reports them.

use serde::Serialize;

use untangle::{
    analysis::Analysis,
    mesh::VertexId,
    paths::{ChainEnd, PairType, PathPair, PathType},
    weld::Weld,
};

/// One pair of corresponding paths.
#[derive(Clone, Debug, Serialize)]
pub struct PairReport {
    /// Type of the pair, as found.
    pub pair_type: PairType,
    /// Whether the path is a closed curve in the world.
    pub closed: bool,
    /// Intersecting pairs of triangles along it.
    pub num_segments: usize,
    /// Length in the world, in metres.
    pub length_m: f64,
    /// Loop vertices; of a welded one the lowest index.
    pub loop_vertices: Vec<u32>,
    /// Free ends; of welded vertices the lowest indices.
    pub ends: Vec<ChainEnd>,
    /// Its paths after splitting.
    pub copies: Vec<CopyReport>,
}

/// One path after splitting.
#[derive(Clone, Debug, Serialize)]
pub struct CopyReport {
    /// Its type.
    #[serde(rename = "type")]
    pub path_type: PathType,
    /// Number of triangles that it passes through, counted each time.
    pub num_segments: usize,
    /// Vertices inside, ascending, of welded ones all; `None` for II and BI.
    pub inside_vertices: Option<Vec<u32>>,
    /// Whether it partitions the cloth.
    pub partitioning: bool,
}

impl PairReport {
    /// All pairs of an analysis.
    pub(in crate::cli) fn of_all(weld: &Weld, analysis: &Analysis) -> Vec<Self> {
        analysis.paths.pairs.iter().map(|pair| Self::new(weld, analysis, pair)).collect()
    }

    fn new(weld: &Weld, analysis: &Analysis, pair: &PathPair) -> Self {
        Self {
            pair_type: pair.pair_type,
            closed: pair.closed,
            num_segments: pair.num_segments,
            length_m: pair.length_m,
            loop_vertices: pair.loop_vertices.iter().map(|&vertex| weld.first(vertex)).collect(),
            ends: pair.ends.iter().map(|&end| in_files(weld, end)).collect(),
            copies: pair.copies.clone().map(|at| CopyReport::new(weld, analysis, at)).collect(),
        }
    }
}

/// An end by the vertices of the files.
fn in_files(weld: &Weld, end: ChainEnd) -> ChainEnd {
    let first = |vertex: u32| weld.first(VertexId(vertex));
    let edge_in_files = |edge: [u32; 2]| {
        let mut edge = edge.map(first);
        edge.sort_unstable();
        edge
    };
    match end {
        ChainEnd::Boundary { edge, face } => ChainEnd::Boundary { edge: edge_in_files(edge), face },
        ChainEnd::Junction { edge, face } => ChainEnd::Junction { edge: edge_in_files(edge), face },
        ChainEnd::Loop { vertex } => ChainEnd::Loop { vertex: first(vertex) },
    }
}

impl CopyReport {
    fn new(weld: &Weld, analysis: &Analysis, at: usize) -> Self {
        let Analysis { paths, regions, .. } = analysis;
        let copy = &paths.copies[at];
        // II and BI bound no region alone; a region that both paths of a pair bound belongs to neither.
        let has_own = !matches!(copy.path_type, PathType::InsideInside | PathType::BoundaryInside);
        let region = regions.by_copy[at].as_ref().filter(|_| has_own);
        let inside = || {
            let inside = regions.vertices_of(at).iter();
            let mut vertices: Vec<u32> = inside.flat_map(|&vertex| weld.copies(vertex)).copied().collect();
            vertices.sort_unstable();
            vertices
        };
        Self {
            path_type: copy.path_type,
            num_segments: copy.segments.len(),
            inside_vertices: region.map(|_| inside()),
            partitioning: region.is_some_and(|region| region.partitioning),
        }
    }
}
