//! Least-squares conformal maps (Lévy, Petitjean, Ray and Maillot 2002).

use nalgebra::Complex;

use super::{arap::Arap, flat_faces::FlatFaces};
use crate::correspond::linalg::{BandMatrix, Cholesky, SparseSymmetric};

/// Weight of the place that a free vertex has in the unfolding: keeps vertices that only a corner connects with the
/// rest from making the system singular.
const FREE_WEIGHT: f64 = 1e-12;

/// The Cauchy-Riemann equations of all faces in the sense of least squares. The plane is that of the complex numbers:
/// one unknown for each vertex.
#[derive(Debug, Default)]
pub(super) struct ConformalMap {
    /// The system of a narrow patch.
    band: BandMatrix<Complex<f64>>,
    /// That of another one, with two real unknowns for each vertex.
    matrix: SparseSymmetric,
    factor: Cholesky,
    unknowns: Vec<f64>,
}

impl ConformalMap {
    /// Writes the conformal map that holds two vertices where the unfolding has them: the first, and the one farthest
    /// from it. False where the system can't be solved.
    ///
    /// The elimination order is that of `arap`, whose system has an entry for each of this one.
    pub(super) fn solve(&mut self, parts: &FlatFaces, arap: &Arap, places: &mut Vec<Complex<f64>>) -> bool {
        places.clear();
        places.extend(parts.start.iter().enumerate().map(|(vertex, place)| place * hold(parts, vertex)));
        if let Some(band) = parts.band() {
            self.band.start(band);
            assemble(parts, |row, column, value| self.band.add(band, row, column, value));
            if !self.band.factorise(band) {
                return false;
            }
            self.band.solve(band, places);
        } else if !self.solve_sparse(parts, arap, places) {
            return false;
        }
        places.iter().all(|place| place.re.is_finite() && place.im.is_finite())
    }

    fn solve_sparse(&mut self, parts: &FlatFaces, arap: &Arap, places: &mut [Complex<f64>]) -> bool {
        self.matrix.start(2 * places.len());
        assemble(parts, |row, column, Complex { re, im }| {
            // A complex number as a matrix of two by two.
            for axis in 0..2 {
                self.matrix.add(2 * row + axis, 2 * column + axis, re);
            }
            if row != column {
                for (axis, part) in [(0, -im), (1, im)] {
                    self.matrix.add(2 * row + axis, 2 * column + 1 - axis, part);
                    self.matrix.add(2 * column + 1 - axis, 2 * row + axis, part);
                    self.matrix.add(2 * column + axis, 2 * row + axis, re);
                }
            }
        });
        self.matrix.compress();
        if !self.factor.factorise_in_pairs_like(&self.matrix, arap.factor()) {
            return false;
        }
        self.unknowns.clear();
        self.unknowns.extend(places.iter().flat_map(|place| [place.re, place.im]));
        self.factor.solve(&mut self.unknowns);
        for (place, pair) in places.iter_mut().zip(self.unknowns.chunks_exact(2)) {
            *place = Complex::new(pair[0], pair[1]);
        }
        true
    }
}

/// Adds up the system: each entry above or below its diagonal once.
fn assemble(parts: &FlatFaces, mut add: impl FnMut(usize, usize, Complex<f64>)) {
    for face in &parts.faces {
        let corners = face.vertices();
        // The derivative of the map is the sum over the corners of their places times the sides opposite them.
        let scale = 1.0 / (2.0 * face.area).sqrt();
        let opposite = [1, 2, 0].map(|k: usize| face.sides[k] * scale);
        for k in 0..3 {
            let next = (k + 1) % 3;
            add(corners[k], corners[k], Complex::new(opposite[k].norm_sqr(), 0.0));
            add(corners[k], corners[next], opposite[k].conj() * opposite[next]);
        }
    }
    for vertex in 0..parts.start.len() {
        add(vertex, vertex, Complex::new(hold(parts, vertex), 0.0));
    }
}

/// How firmly a vertex is held where the unfolding has it.
fn hold(parts: &FlatFaces, vertex: usize) -> f64 {
    if parts.held.contains(&vertex) || !parts.is_used[vertex] { 1.0 } else { FREE_WEIGHT }
}
