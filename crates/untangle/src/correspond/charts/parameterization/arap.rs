//! As-rigid-as-possible parameterisation: the local-global iteration of Liu, Zhang, Xu, Gotsman and Gortler (2008),
//! after Sorkine and Alexa (2007).

use nalgebra::Complex;

use super::flat_faces::{FlatFace, FlatFaces};
use crate::correspond::linalg::{BandMatrix, Cholesky, SparseSymmetric};

const ITERATIONS: usize = 8;
/// Weight of the place that a free vertex had in the last iteration, which keeps the system definite.
const FREE_WEIGHT: f64 = 1e-9;

/// The cotangent Laplacian of the faces, factorised.
#[derive(Debug, Default)]
pub(super) struct Arap {
    /// The system of a narrow patch.
    band: BandMatrix<f64>,
    /// That of another one, and what its solutions go through, one for each axis.
    matrix: SparseSymmetric,
    factor: Cholesky,
    axes: [Vec<f64>; 2],
    pulls: Vec<Pulls>,
    unknowns: Vec<Complex<f64>>,
}

/// What a face that is not rotated adds to the right-hand sides of its corners: together nothing.
#[derive(Debug)]
struct Pulls {
    corners: [usize; 3],
    values: [Complex<f64>; 3],
}

impl Arap {
    /// Factorises the global system, which does not depend on places. False where it is not positive definite.
    pub(super) fn factorise(&mut self, parts: &FlatFaces) -> bool {
        self.pulls.clear();
        self.pulls.extend(parts.faces.iter().map(Pulls::new));
        if let Some(band) = parts.band() {
            self.band.start(band);
            assemble(parts, |row, column, value| self.band.add(band, row, column, value));
            return self.band.factorise(band);
        }
        self.matrix.start(parts.start.len());
        assemble(parts, |row, column, value| {
            self.matrix.add(row, column, value);
            if row != column {
                self.matrix.add(column, row, value);
            }
        });
        self.matrix.compress();
        self.factor.factorise(&self.matrix)
    }

    /// The factor of the global system of a patch that is not narrow.
    pub(super) fn factor(&self) -> &Cholesky {
        &self.factor
    }

    /// Alternates the best rotation of every face (local step) and the best places for these rotations (global step).
    /// False where a place is not finite.
    pub(super) fn iterate(&mut self, parts: &FlatFaces, points: &mut [Complex<f64>]) -> bool {
        for _ in 0..ITERATIONS {
            self.rotate_faces(parts, points);
            match parts.band() {
                Some(band) => self.band.solve(band, &mut self.unknowns),
                None => self.solve_sparse(),
            }
            points.copy_from_slice(&self.unknowns);
        }
        points.iter().all(|point| point.re.is_finite() && point.im.is_finite())
    }

    fn solve_sparse(&mut self) {
        let parts: [fn(&Complex<f64>) -> f64; 2] = [|place| place.re, |place| place.im];
        for (values, part) in self.axes.iter_mut().zip(parts) {
            values.clear();
            values.extend(self.unknowns.iter().map(part));
            self.factor.solve(values);
        }
        let [x, y] = &self.axes;
        for (place, (&x, &y)) in self.unknowns.iter_mut().zip(x.iter().zip(y)) {
            *place = Complex::new(x, y);
        }
    }

    /// Writes the right-hand sides: the sides of all shapes, each face rotated as fits its present places best.
    fn rotate_faces(&mut self, parts: &FlatFaces, points: &[Complex<f64>]) {
        self.unknowns.clear();
        self.unknowns.extend(points.iter().enumerate().map(|(vertex, point)| point * hold(parts, vertex)));
        for &Pulls { corners: [a, b, c], values: [of_a, of_b, of_c] } in &self.pulls {
            let origin = points[a];
            let fit = of_b.conj() * (points[b] - origin) + of_c.conj() * (points[c] - origin);
            let length = fit.norm_sqr().sqrt();
            let rotation = if length > 0.0 { fit * (1.0 / length) } else { Complex::new(1.0, 0.0) };
            self.unknowns[a] += rotation * of_a;
            self.unknowns[b] += rotation * of_b;
            self.unknowns[c] += rotation * of_c;
        }
    }
}

impl Pulls {
    fn new(face: &FlatFace) -> Self {
        let weighted = [0, 1, 2].map(|k: usize| face.sides[k] * face.weights[k]);
        // A side pulls its second end along, and its first one back.
        let values = [0, 1, 2].map(|k: usize| weighted[(k + 2) % 3] - weighted[k]);
        Self { corners: face.vertices(), values }
    }
}

/// Adds up the global system: each entry above or below its diagonal once.
fn assemble(parts: &FlatFaces, mut add: impl FnMut(usize, usize, f64)) {
    for face in &parts.faces {
        let corners = face.vertices();
        let [p, q, r] = face.weights;
        for (k, sum) in [r + p, p + q, q + r].into_iter().enumerate() {
            add(corners[k], corners[k], sum);
            add(corners[k], corners[(k + 1) % 3], -face.weights[k]);
        }
    }
    for vertex in 0..parts.start.len() {
        add(vertex, vertex, hold(parts, vertex));
    }
}

/// How firmly a vertex is held where it lies: the first one, and those without a face, keep their places.
fn hold(parts: &FlatFaces, vertex: usize) -> f64 {
    if vertex == parts.held[0] || !parts.is_used[vertex] { 1.0 } else { FREE_WEIGHT }
}
