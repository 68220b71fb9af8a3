//! Which primitives of a cloth are nearer to each other than a distance, exactly.
//!
//! Primitives are the vertices, edges and triangles of triangles with three different vertices. Pairs are a vertex and
//! a triangle, or two edges, without a common vertex. Each decision is a comparison of polynomials: in interval
//! arithmetic first, and in whole numbers where the intervals overlap.

mod measure;
mod number;
mod search;

use crate::{CheckError, primitive::Point, validate};

use measure::{edges_near, vertex_near};
pub(crate) use search::Boxes;

/// Most pairs that are counted.
const MOST_PAIRS: usize = 10_000_000;

/// How many pairs of primitives are nearer than a distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NearPairs {
    /// Vertices and triangles.
    pub num_vertex_triangle: usize,
    /// Edges and edges.
    pub num_edge_edge: usize,
    /// Whether these are all; the search ends at ten millions.
    pub is_complete: bool,
}

impl NearPairs {
    /// All pairs together.
    #[must_use]
    pub fn total(&self) -> usize {
        self.num_vertex_triangle + self.num_edge_edge
    }
}

/// Counts the pairs of primitives without a common vertex whose distance is below `distance_m`, which is positive and
/// taken as it is, to the bit. The triangles from `first_body` on are those of bodies, and share no vertex with the
/// others: two primitives of bodies are no pair.
///
/// Cost: O(n log n) and a test for each pair whose boxes come within the distance of each other.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn near_pairs(
    positions: &[Point],
    triangles: &[[u32; 3]],
    first_body: usize,
    distance_m: f64,
) -> Result<NearPairs, CheckError> {
    validate(positions, triangles)?;
    let mut is_body = vec![false; positions.len()];
    for &vertex in triangles.iter().skip(first_body).flatten() {
        is_body[vertex as usize] = true;
    }
    let are_bodies = |a: u32, b: u32| is_body[a as usize] && is_body[b as usize];
    let triangles: Vec<[u32; 3]> = triangles.iter().copied().filter(|&[a, b, c]| a != b && b != c && c != a).collect();
    let mut edges: Vec<[u32; 2]> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let at = |vertex: u32| positions[vertex as usize];
    let mut found = NearPairs { is_complete: true, ..NearPairs::default() };
    let tree = Boxes::new(triangles.iter().map(|triangle| triangle.map(at)));
    for &vertex in &vertices {
        tree.near([at(vertex)], distance_m, |index| {
            let triangle = triangles[index];
            let skipped = triangle.contains(&vertex) || are_bodies(vertex, triangle[0]);
            if !skipped && vertex_near(at(vertex), triangle.map(at), distance_m) {
                found.num_vertex_triangle += 1;
            }
        });
    }
    let tree = Boxes::new(edges.iter().map(|edge| edge.map(at)));
    for (own, edge) in edges.iter().enumerate() {
        if found.total() > MOST_PAIRS {
            found.is_complete = false;
            break;
        }
        tree.near(edge.map(at), distance_m, |index| {
            let other = edges[index];
            let skipped = other.iter().any(|end| edge.contains(end)) || are_bodies(edge[0], other[0]);
            if index > own && !skipped && edges_near(edge.map(at), other.map(at), distance_m) {
                found.num_edge_edge += 1;
            }
        });
    }
    Ok(found)
}
