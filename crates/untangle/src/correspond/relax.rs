//! Charts of surfaces that don't unfold: conformal start, then as rigid as possible.
//!
//! Two linear systems: least-squares conformal maps (Lévy, Petitjean, Ray and Maillot 2002) give a start without folds also for an
//! annulus, where unfolding tears; then the local-global iteration of Liu, Zhang, Xu, Gotsman and Gortler (2008) brings the lengths
//! back. Weights are cotangents of the shapes, kept positive so that the systems stay definite.

use nalgebra::{Point2, Vector2};

use super::{
    cholesky::Cholesky,
    patch::Patch,
    shapes::Shape,
    unfold::{Facing, Unfolding},
};

const RIGID_ITERATIONS: usize = 8;
/// Smallest weight of a side, and smallest area of a face as a part of its longest side squared.
const SMALLEST_WEIGHT: f64 = 0.05;
const SMALLEST_AREA: f64 = 1e-3;

/// Memory of the two systems.
#[derive(Debug, Default)]
pub(crate) struct Relaxation {
    faces: Vec<Face>,
    scales: Vec<f64>,
    start: Vec<Point2<f64>>,
    used: Vec<bool>,
    conformal: Cholesky,
    rigid: Cholesky,
    unknowns: [Vec<f64>; 2],
}

impl Relaxation {
    /// Replaces the places of an unfolding by those of a map with as little change of shape as possible. False, with the places
    /// untouched, where a system can't be solved.
    pub(crate) fn relax(&mut self, patch: &Patch, shapes: &[Shape], unfolding: &mut Unfolding) -> bool {
        self.start.clear();
        self.start.extend_from_slice(&unfolding.points);
        self.used.clear();
        self.used.resize(unfolding.points.len(), false);
        unfolding.scales(patch, shapes, &mut self.scales);
        faces_of(patch, shapes, &unfolding.facing, &self.scales, &mut self.faces);
        for corner in self.faces.iter().flat_map(|face| face.corners) {
            self.used[corner] = true;
        }
        let points = &mut unfolding.points;
        if self.faces.is_empty() || !self.prepare_rigid() || !self.conform(points) || !self.stiffen(points) {
            points.copy_from_slice(&self.start);
            return false;
        }
        true
    }

    /// Least squares of the Cauchy-Riemann equations of all faces, two vertices held where they lie.
    fn conform(&mut self, points: &mut [Point2<f64>]) -> bool {
        let num_points = points.len();
        self.conformal.start(2 * num_points);
        for face in &self.faces {
            // Row of the real part: w.x u - w.y v; of the imaginary part: w.y u + w.x v; w is the side opposite the corner.
            let opposite = [1, 2, 0].map(|k: usize| face.sides[k] / (2.0 * face.area).sqrt());
            let unknown = |k: usize| 2 * face.corners[k / 2] + k % 2;
            let rows: [[f64; 2]; 6] = std::array::from_fn(|k| {
                let side = opposite[k / 2];
                if k % 2 == 0 { [side.x, side.y] } else { [-side.y, side.x] }
            });
            for (i, [a, c]) in rows.into_iter().enumerate() {
                for (j, [b, d]) in rows.into_iter().enumerate() {
                    self.conformal.add(unknown(i), unknown(j), a * b + c * d);
                }
            }
        }
        let start = &self.start;
        let first = self.faces[0].corners[0];
        let mut second = first;
        for (vertex, _) in self.used.iter().enumerate().filter(|&(_, &used)| used) {
            if (start[vertex] - start[first]).norm_squared() > (start[second] - start[first]).norm_squared() {
                second = vertex;
            }
        }
        let [unknowns, _] = &mut self.unknowns;
        unknowns.clear();
        for (vertex, place) in start.iter().enumerate() {
            let held = vertex == first || vertex == second || !self.used[vertex];
            // The tiny weight keeps vertices that hang on by nothing but a corner from making the system singular.
            let weight = if held { 1.0 } else { 1e-12 };
            for (axis, &value) in place.iter().enumerate() {
                self.conformal.add(2 * vertex + axis, 2 * vertex + axis, weight);
                unknowns.push(weight * value);
            }
        }
        if !self.conformal.factorise_in_pairs_like(&self.rigid) {
            return false;
        }
        self.conformal.solve(unknowns);
        for (point, place) in points.iter_mut().zip(unknowns.chunks_exact(2)) {
            *point = Point2::new(place[0], place[1]);
        }
        unknowns.iter().all(|value| value.is_finite())
    }

    /// Factorises the system of [`stiffen`](Self::stiffen), which does not depend on places.
    fn prepare_rigid(&mut self) -> bool {
        self.rigid.start(self.start.len());
        for face in &self.faces {
            for (k, &weight) in face.weights.iter().enumerate() {
                let (a, b) = (face.corners[k], face.corners[(k + 1) % 3]);
                for (row, column, value) in [(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)] {
                    self.rigid.add(row, column, value);
                }
            }
        }
        for vertex in 0..self.start.len() {
            self.rigid.add(vertex, vertex, self.hold(vertex));
        }
        self.rigid.factorise()
    }

    /// How firmly a vertex is held where it lies.
    fn hold(&self, vertex: usize) -> f64 {
        if vertex == self.faces[0].corners[0] || !self.used[vertex] { 1.0 } else { 1e-9 }
    }

    /// As rigid as possible: alternates the best rotation of every face and the best places for these rotations.
    fn stiffen(&mut self, points: &mut [Point2<f64>]) -> bool {
        for _ in 0..RIGID_ITERATIONS {
            let mut unknowns = std::mem::take(&mut self.unknowns);
            for (axis, places) in unknowns.iter_mut().enumerate() {
                places.clear();
                places.extend(points.iter().enumerate().map(|(vertex, point)| self.hold(vertex) * point[axis]));
            }
            for face in &self.faces {
                let mut spin = Vector2::zeros();
                for (k, &weight) in face.weights.iter().enumerate() {
                    let (shape, lies) = (face.sides[k], points[face.corners[(k + 1) % 3]] - points[face.corners[k]]);
                    spin += Vector2::new(shape.dot(&lies), shape.perp(&lies)) * weight;
                }
                let spin = spin.try_normalize(0.0).unwrap_or_else(Vector2::x);
                for (k, &weight) in face.weights.iter().enumerate() {
                    let side = face.sides[k];
                    let turned =
                        Vector2::new(spin.x * side.x - spin.y * side.y, spin.y * side.x + spin.x * side.y) * weight;
                    for (axis, places) in unknowns.iter_mut().enumerate() {
                        places[face.corners[k]] -= turned[axis];
                        places[face.corners[(k + 1) % 3]] += turned[axis];
                    }
                }
            }
            unknowns.iter_mut().for_each(|places| self.rigid.solve(places));
            let [x, y] = &unknowns;
            for (point, (&x, &y)) in points.iter_mut().zip(x.iter().zip(y)) {
                *point = Point2::new(x, y);
            }
            self.unknowns = unknowns;
        }
        points.iter().all(|point| point.x.is_finite() && point.y.is_finite())
    }
}

/// A reached face with its shape as it lies in the chart, at the scale of the unfolding.
#[derive(Debug)]
struct Face {
    corners: [usize; 3],
    sides: [Vector2<f64>; 3],
    area: f64,
    weights: [f64; 3],
}

fn faces_of(patch: &Patch, shapes: &[Shape], facing: &[Facing], scales: &[f64], faces: &mut Vec<Face>) {
    faces.clear();
    let placed = facing.iter().zip(scales);
    for ((corners, shape), (facing, &scale)) in patch.corners().iter().zip(shapes).zip(placed) {
        let mut shape = *shape;
        match facing {
            Facing::Unreached => continue,
            Facing::Straight => {}
            Facing::Mirrored => {
                for point in &mut shape {
                    point.y = -point.y;
                }
            }
        }
        let corners = corners.map(|vertex| vertex as usize);
        let sides = sides(&shape).map(|side| side * scale);
        let smallest = SMALLEST_AREA * longest(&sides).powi(2);
        let area = (0.5 * sides[0].perp(&sides[2])).abs().max(smallest);
        // The cotangent at the corner opposite side k, between the two other sides.
        let weights = [0, 1, 2].map(|k| {
            let cotangent = -sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]) / (2.0 * area);
            (0.5 * cotangent).clamp(SMALLEST_WEIGHT, 1.0 / SMALLEST_WEIGHT)
        });
        faces.push(Face { corners, sides, area, weights });
    }
}

fn sides(at: &Shape) -> [Vector2<f64>; 3] {
    [at[1] - at[0], at[2] - at[1], at[0] - at[2]]
}

fn longest(sides: &[Vector2<f64>; 3]) -> f64 {
    sides.iter().map(Vector2::norm).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::{
        correspond::{samples::all_faces, samples::sheet_faces, shapes::flat},
        mesh::{Mesh, MeshDescription},
    };

    /// The largest relative change of an edge, and whether every face has the same turn.
    fn quality(patch: &Patch, shapes: &[Shape], unfolding: &Unfolding) -> (f64, bool) {
        let mut worst: f64 = 0.0;
        let mut turns = [0, 0];
        for (corners, shape) in patch.corners().iter().zip(shapes) {
            let lies = corners.map(|vertex| unfolding.points[vertex as usize]);
            for (a, b) in sides(&lies).iter().zip(&sides(shape)) {
                worst = worst.max((a.norm() / b.norm()).ln().abs());
            }
            turns[usize::from((lies[1] - lies[0]).perp(&(lies[2] - lies[0])) > 0.0)] += 1;
        }
        (worst, turns.contains(&0))
    }

    fn chart(num_vertices: usize, faces: Vec<[u32; 3]>, at: impl Fn(usize) -> Point3<f64>) -> (f64, bool, f64) {
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
        let mut patch = Patch::default();
        patch.start(&mesh, all_faces(&mesh).into_iter());
        let shapes: Vec<Shape> =
            patch.corners().iter().map(|c| flat(c.map(|v| at(patch.vertices()[v as usize].index())))).collect();
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(&mesh, &patch, &shapes));
        let torn = unfolding.misfit;
        assert!(Relaxation::default().relax(&patch, &shapes, &mut unfolding));
        let (worst, fair) = quality(&patch, &shapes, &unfolding);
        (worst, fair, torn)
    }

    #[test]
    fn a_dome_becomes_flat_with_little_strain() {
        let (worst, fair, torn) = chart(81, sheet_faces(8, 8), |vertex| {
            let (x, y) = (vertex % 9, vertex / 9);
            let (x, y) = (x as f64 / 8.0 - 0.5, y as f64 / 8.0 - 0.5);
            Point3::new(x, y, 0.6 * (0.6 - x * x - y * y))
        });
        assert!(torn > 0.05, "{torn}");
        assert!(fair && worst < 0.1, "{worst}");
    }

    #[test]
    fn a_ring_of_a_cone_becomes_an_annulus() {
        // Closed in one direction: 24 columns, 4 rows of a steep frustum.
        let (columns, rows) = (24u32, 3u32);
        let mut faces = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let a = row * columns + column;
                let b = row * columns + (column + 1) % columns;
                faces.push([a, b, a + columns]);
                faces.push([a + columns, b, b + columns]);
            }
        }
        let (worst, fair, torn) = chart(96, faces, |vertex| {
            let (column, row) = (vertex % 24, vertex / 24);
            let angle = column as f64 / 24.0 * std::f64::consts::TAU;
            let radius = 1.0 + 0.2 * row as f64;
            Point3::new(radius * angle.cos(), radius * angle.sin(), 0.1 * row as f64)
        });
        assert!(torn > 0.1, "{torn}");
        assert!(fair && worst < 0.2, "{worst}");
    }
}
