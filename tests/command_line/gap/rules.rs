//! Distances of all pairs of primitives of a file, one by one, as other tools see them.

use std::{collections::BTreeSet, fs, path::Path};

type Point = [f64; 3];

/// Triangles as a test reads them from an OBJ.
pub(super) struct TestMesh {
    positions: Vec<Point>,
    triangles: Vec<[usize; 3]>,
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn point_segment(p: Point, [a, b]: [Point; 2]) -> f64 {
    let (along, offset) = (sub(b, a), sub(p, a));
    let parameter = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
    let rest: Point = std::array::from_fn(|axis| offset[axis] - parameter * along[axis]);
    dot(rest, rest)
}

fn point_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let normal = cross(sub(b, a), sub(c, a));
    let is_inside = |from: Point, to: Point| dot(cross(sub(to, from), sub(p, from)), normal) >= 0.0;
    if is_inside(a, b) && is_inside(b, c) && is_inside(c, a) {
        return dot(sub(p, a), normal).powi(2) / dot(normal, normal);
    }
    point_segment(p, [a, b]).min(point_segment(p, [b, c])).min(point_segment(p, [c, a]))
}

fn segment_segment([a, b]: [Point; 2], [c, d]: [Point; 2]) -> f64 {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
    let normal = cross(u, v);
    let size = dot(normal, normal);
    let [s, t] = [dot(cross(w, v), normal) / size, dot(cross(w, u), normal) / size];
    if size > 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return dot(w, normal).powi(2) / size;
    }
    let ends = [point_segment(a, [c, d]), point_segment(b, [c, d]), point_segment(c, [a, b]), point_segment(d, [a, b])];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

impl TestMesh {
    /// Reads an OBJ of triangles, rounded to single precision if asked for.
    pub(super) fn read(path: &Path, single: bool) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let numbers = |line: &str| -> Point {
            let mut words = line.split_whitespace();
            std::array::from_fn(|_| words.next().unwrap().parse().unwrap())
        };
        #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
        let seen = |value: f64| if single { f64::from(value as f32) } else { value };
        let index = |word: &str| word.split('/').next().unwrap().parse::<usize>().unwrap() - 1;
        let positions =
            text.lines().filter_map(|line| line.strip_prefix("v ")).map(|line| numbers(line).map(seen)).collect();
        let triangles = text.lines().filter_map(|line| line.strip_prefix("f ")).map(|line| {
            let mut words = line.split_whitespace();
            std::array::from_fn(|_| index(words.next().unwrap()))
        });
        Self { positions, triangles: triangles.collect() }
    }

    fn edges(&self) -> Vec<[usize; 2]> {
        let sides = self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edges: BTreeSet<[usize; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.into_iter().collect()
    }

    pub(super) fn mean_edge(&self) -> f64 {
        let edges = self.edges();
        let length = |&[a, b]: &[usize; 2]| {
            let along = sub(self.positions[b], self.positions[a]);
            dot(along, along).sqrt()
        };
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let count = edges.len() as f64;
        edges.iter().map(length).sum::<f64>() / count
    }

    /// The squared distances of all vertices and triangles, edges and edges, without a common vertex.
    pub(super) fn squared_distances(&self) -> Vec<f64> {
        let mut all = Vec::new();
        for (vertex, &position) in self.positions.iter().enumerate() {
            for triangle in self.triangles.iter().filter(|triangle| !triangle.contains(&vertex)) {
                all.push(point_triangle(position, triangle.map(|corner| self.positions[corner])));
            }
        }
        let edges = self.edges();
        for (index, edge) in edges.iter().enumerate() {
            for other in edges[index + 1..].iter().filter(|other| other.iter().all(|end| !edge.contains(end))) {
                let [first, second] = [edge, other].map(|ends| ends.map(|end| self.positions[end]));
                all.push(segment_segment(first, second));
            }
        }
        all
    }
}
