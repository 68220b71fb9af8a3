//! The judge: an exact test of whether a cloth touches or crosses itself. It shares no code with the untangler, on
//! purpose, so that a fault of the untangler can't hide itself.
//!
//! Tested are all pairs of an edge and a triangle without a common vertex, as closed sets: touching counts. Every
//! decision is the exact sign of a determinant (Shewchuk 1997, crate `robust`), and a sign of zero means *on*. There is
//! no perturbation and no tolerance. Pairs come from a sweep along one axis, whose comparisons are exact too.

mod primitive;
#[cfg(test)]
mod tests;

use thiserror::Error;

pub use primitive::Point;

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
/// Cost: O(n log n) and a box test for each pair whose extents overlap along the longest axis of the cloth.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn edge_face_hits(positions: &[Point], triangles: &[[u32; 3]]) -> Result<Vec<EdgeFaceHit>, CheckError> {
    validate(positions, triangles)?;
    let axis = longest_axis(positions);
    let edges = sorted_by_start(unique_edges(triangles), axis, |edge| Extent::of(edge.map(|v| positions[v as usize])));
    let faces = sorted_by_start((0..).zip(triangles.iter().copied()).collect(), axis, |(_, triangle)| {
        Extent::of(triangle.map(|v| positions[v as usize]))
    });

    let mut hits = Vec::new();
    let mut test = |&(edge, ref edge_extent): &([u32; 2], Extent), &(face, ref extent): &((u32, [u32; 3]), Extent)| {
        let (index, triangle) = face;
        if extent.overlaps(edge_extent)
            && edge.iter().all(|vertex| !triangle.contains(vertex))
            && primitive::segment_meets_triangle(
                edge.map(|vertex| positions[vertex as usize]),
                triangle.map(|vertex| positions[vertex as usize]),
            )
        {
            hits.push(EdgeFaceHit { edge, triangle: index });
        }
    };
    // Of two overlapping intervals one starts inside the other: at its start, both at once, or later.
    for face in &faces {
        let first = edges.partition_point(|(_, extent)| extent.low[axis] < face.1.low[axis]);
        for edge in edges[first..].iter().take_while(|(_, extent)| extent.low[axis] <= face.1.high[axis]) {
            test(edge, face);
        }
    }
    for edge in &edges {
        let first = faces.partition_point(|(_, extent)| extent.low[axis] <= edge.1.low[axis]);
        for face in faces[first..].iter().take_while(|(_, extent)| extent.low[axis] <= edge.1.high[axis]) {
            test(edge, face);
        }
    }
    hits.sort_unstable();
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

fn unique_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn longest_axis(positions: &[Point]) -> usize {
    let extent = Extent::of(positions.iter().copied());
    let length = |axis: usize| extent.high[axis] - extent.low[axis];
    (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best })
}

fn sorted_by_start<T: Copy + Ord>(items: Vec<T>, axis: usize, extent: impl Fn(T) -> Extent) -> Vec<(T, Extent)> {
    let mut items: Vec<_> = items.into_iter().map(|item| (item, extent(item))).collect();
    items.sort_unstable_by(|a, b| a.1.low[axis].total_cmp(&b.1.low[axis]).then(a.0.cmp(&b.0)));
    items
}

/// A box with sides along the axes. Made of input coordinates only: nothing is rounded.
#[derive(Clone, Copy, Debug)]
struct Extent {
    low: Point,
    high: Point,
}

impl Extent {
    fn of(points: impl IntoIterator<Item = Point>) -> Self {
        let empty = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        points.into_iter().fold(empty, |mut extent, point| {
            for ((low, high), value) in extent.low.iter_mut().zip(&mut extent.high).zip(point) {
                *low = low.min(value);
                *high = high.max(value);
            }
            extent
        })
    }

    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }
}
