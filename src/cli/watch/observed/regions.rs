//! Which path a vertex inside belongs to. A frame says of a vertex that it is inside, not of what: it is taken for the
//! path that is nearest along edges between vertices inside. For colours and round numbers, not for decisions.

use std::collections::VecDeque;

use untangled_client::{PathPoint, PathRecord};

/// Instead of the number of a pair.
pub(super) const NONE: u32 = u32::MAX;

/// The vertices beside each vertex.
#[derive(Debug)]
pub(super) struct Neighbours {
    /// Where those of each vertex begin, and the end.
    first: Vec<u32>,
    vertices: Vec<u32>,
}

/// What is inside of each pair of paths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Region {
    pub(super) num_vertices: usize,
    /// How far the farthest vertex is from the path along edges, in metres.
    pub(super) depth_m: f32,
}

impl Neighbours {
    pub(super) fn new(num_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut edges: Vec<[u32; 2]> =
            triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut first = vec![0; num_vertices + 1];
        for &[from, _] in &edges {
            first[from as usize + 1] += 1;
        }
        for vertex in 0..num_vertices {
            first[vertex + 1] += first[vertex];
        }
        Self { first, vertices: edges.iter().map(|&[_, to]| to).collect() }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.vertices[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }

    /// The pair of each vertex inside, [`NONE`] for all others, and what is inside of each pair.
    pub(super) fn regions(
        &self,
        triangles: &[[u32; 3]],
        positions: &[[f32; 3]],
        is_inside: impl Fn(u32) -> bool,
        paths: (&[PathRecord], &[PathPoint]),
    ) -> (Vec<u32>, Vec<Region>) {
        let (records, points) = paths;
        let num_pairs = records.iter().map(|record| record.pair as usize + 1).max().unwrap_or(0);
        let (mut pairs, mut regions) = (vec![NONE; positions.len()], vec![Region::default(); num_pairs]);
        let mut queue = VecDeque::new();
        for record in records {
            for point in record.points(points) {
                for &vertex in triangles.get(point.faces[0] as usize).into_iter().flatten() {
                    if is_inside(vertex) && pairs[vertex as usize] == NONE {
                        pairs[vertex as usize] = record.pair;
                        let place = point.position_m.map(single);
                        queue.push_back((vertex, distance(place, positions[vertex as usize])));
                    }
                }
            }
        }
        while let Some((vertex, depth)) = queue.pop_front() {
            let pair = pairs[vertex as usize];
            let region = &mut regions[pair as usize];
            region.num_vertices += 1;
            region.depth_m = region.depth_m.max(depth);
            for &next in self.of(vertex) {
                if is_inside(next) && pairs[next as usize] == NONE {
                    pairs[next as usize] = pair;
                    queue.push_back((next, depth + distance(positions[vertex as usize], positions[next as usize])));
                }
            }
        }
        (pairs, regions)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "to look at")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}

pub(super) fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_inside_belong_to_the_nearest_path_along_edges() {
        // A strip of quads; paths cross the first and the last of them, vertices 3 to 8 are inside, 6 and 7 are not.
        let triangles: Vec<[u32; 3]> =
            (0..5u32).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 2, 2 * k + 1, 2 * k + 3]]).collect();
        let positions: Vec<[f32; 3]> = (0..12u8).map(|k| [f32::from(k / 2), f32::from(k % 2), 0.0]).collect();
        let point = |x: f64, face| PathPoint { position_m: [x, 0.0, 0.0], faces: [face, face] };
        let points = [point(0.5, 0), point(0.5, 1), point(4.5, 8), point(4.5, 9)];
        let record = |pair, first_point| PathRecord { pair, first_point, num_points: 2, ..PathRecord::default() };
        let records = [record(0, 0), record(1, 2)];
        let neighbours = Neighbours::new(12, &triangles);
        assert_eq!(neighbours.of(2), [0, 1, 3, 4]);
        let is_inside = |vertex| (2..10).contains(&vertex) && vertex != 6 && vertex != 7;
        let (pairs, regions) = neighbours.regions(&triangles, &positions, is_inside, (&records, &points));
        assert_eq!(pairs, [NONE, NONE, 0, 0, 0, 0, NONE, NONE, 1, 1, NONE, NONE]);
        assert_eq!(regions.iter().map(|region| region.num_vertices).collect::<Vec<_>>(), [4, 2]);
        assert!((regions[0].depth_m - 1.5).abs() < 0.7, "{regions:?}");
    }
}
