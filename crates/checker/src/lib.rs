//! The judge: exact tests of whether a cloth touches or crosses itself. It shares no code with the untangler, on
//! purpose, so that a fault of the untangler can't hide itself.
//!
//! Every decision is the exact sign of a determinant (Shewchuk 1997, crate `robust`), or of a polynomial in whole
//! numbers, and a sign of zero means *on*. There is no perturbation and no tolerance. What is answered:
//!
//! - [`edge_face_hits`]: which edges and triangles without a common vertex have a common point, as closed sets.
//!   Touching counts.
//! - [`crossings`]: which triangles cross *properly*, so that no small motion parts them. Touching does not count.
//!   [`fan_crossings`] asks that of all the ways in which a reader may split polygons into triangles. What a body
//!   crosses of itself is left out.
//! - [`vertices_inside`]: which vertices of a cloth are inside of a body.
//! - [`vertices_behind`]: which vertices of a layer are behind one that lies further in; by rounded numbers.
//!   [`vertices_behind_layers`] asks that of all layers in order.
//! - [`near_pairs`]: which primitives without a common vertex are nearer than a distance. At exactly the distance they
//!   are not.
//!
//! Pairs come from a tree of boxes, whose comparisons are exact too.

mod behind;
mod crossing;
mod distance;
mod fans;
mod groups;
mod inside;
mod polygon;
mod primitive;
mod surface;
#[cfg(test)]
mod tests;
mod tree;

use thiserror::Error;

pub use behind::{vertices_behind, vertices_behind_layers};
pub use distance::{NearPairs, near_pairs};
pub use fans::{fan_crossings, polygon_crossings};
pub use inside::vertices_inside;
pub use polygon::PolygonRef;
pub use primitive::Point;
pub use surface::{Crossings, crossings};

use groups::Groups;
use tree::{Next, Tree};

/// A cloth that can't be judged.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum CheckError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {0} is not at a finite position")]
    NotFinite(usize),
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {num_vertices} vertices")]
    Index {
        /// The triangle at fault.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        num_vertices: usize,
    },
}

/// An edge and a triangle that share no vertex and have a point in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct EdgeFaceHit {
    /// The two vertices of the edge, the lower index first.
    pub edge: [u32; 2],
    /// Index of the triangle.
    pub triangle: u32,
}

/// Number of pairs of an edge and a triangle that share no vertex and have a point in common. Zero is what "clean"
/// means.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn count_edge_face(positions: &[Point], triangles: &[[u32; 3]]) -> Result<usize, CheckError> {
    Ok(edge_face_hits(positions, triangles)?.len())
}

/// All pairs of an edge and a triangle that share no vertex and have a point in common, ascending.
///
/// Cost: O(n log n) and a test for each pair of triangles whose boxes overlap.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn edge_face_hits(positions: &[Point], triangles: &[[u32; 3]]) -> Result<Vec<EdgeFaceHit>, CheckError> {
    validate(positions, triangles)?;
    let mut hits = Vec::new();
    let mut test = |index: u32, other: u32| {
        let triangle = triangles[index as usize];
        let [a, b, c] = triangles[other as usize];
        for edge in [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]] {
            if edge.iter().all(|vertex| !triangle.contains(vertex))
                && primitive::segment_meets_triangle(
                    edge.map(|vertex| positions[vertex as usize]),
                    triangle.map(|vertex| positions[vertex as usize]),
                )
            {
                hits.push(EdgeFaceHit { edge, triangle: index });
            }
        }
    };
    let mut groups = Groups::default();
    Tree::new(positions, triangles, &groups).pairs(&mut groups, &mut |first, second| {
        test(first, second);
        test(second, first);
        Next::GoOn
    });
    // An edge of two triangles was tested for both.
    hits.sort_unstable();
    hits.dedup();
    Ok(hits)
}

/// Pairs of triangles that an edge-face hit makes touch or cross, lower index first, ascending. Pairs that share one
/// vertex are among them where they meet beyond it.
#[must_use]
pub fn face_pairs(hits: &[EdgeFaceHit], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut by_edge: Vec<([u32; 2], u32)> = (0..)
        .zip(triangles)
        .flat_map(|(index, &[a, b, c])| [(a, b), (b, c), (c, a)].map(|(p, q)| ([p.min(q), p.max(q)], index)))
        .collect();
    by_edge.sort_unstable();
    let mut pairs = Vec::new();
    for hit in hits {
        let first = by_edge.partition_point(|&(edge, _)| edge < hit.edge);
        for &(_, other) in by_edge[first..].iter().take_while(|&&(edge, _)| edge == hit.edge) {
            pairs.push([other.min(hit.triangle), other.max(hit.triangle)]);
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

fn validate(positions: &[Point], triangles: &[[u32; 3]]) -> Result<(), CheckError> {
    if let Some(vertex) = positions.iter().position(|point| !point.iter().all(|value| value.is_finite())) {
        return Err(CheckError::NotFinite(vertex));
    }
    let num_vertices = positions.len();
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= num_vertices) {
            return Err(CheckError::Index { triangle, vertex, num_vertices });
        }
    }
    Ok(())
}
