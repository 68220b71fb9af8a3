//! Thin-plate interpolation of a map of the plane.
//!
//! `d(x) = a0 + a1 x + a2 y + sum_j w_j phi(|x - c_j|)` with `phi(r) = r^2 log r`, so that `d(c_i) = v_i` and the weights have
//! no affine part (Wicke, Lanker and Gross 2006, equations 1 to 3; the matrix A there is n x 3, not n x 4). Both sides are centred
//! and scaled to unit size first: without that the condition number is that of the unit of length.

use faer::{
    Conj, MatMut, MatRef, Par,
    linalg::{
        householder::{
            apply_block_householder_sequence_transpose_on_the_left_in_place_scratch,
            apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj,
        },
        qr::{
            col_pivoting::factor::{qr_in_place, qr_in_place_scratch},
            no_pivoting::factor::recommended_block_size,
        },
    },
};
use nalgebra::{Point2, Vector2};

use super::memory::Memory;

/// Pivots below this part of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-11;

/// A smooth map of the plane that takes given centres to given values.
#[derive(Debug, Default)]
pub(crate) struct ThinPlate {
    centres: Vec<Point2<f64>>,
    weights: Vec<Vector2<f64>>,
    polynomial: [Vector2<f64>; 3],
    from: Scaling,
    to: Scaling,
    solver: Solver,
}

/// Takes a set of points to mean 0 and greatest distance 1.
#[derive(Clone, Copy, Debug)]
struct Scaling {
    centre: Point2<f64>,
    size: f64,
}

impl Default for Scaling {
    fn default() -> Self {
        Self { centre: Point2::origin(), size: 1.0 }
    }
}

impl Scaling {
    fn of(points: &[Point2<f64>]) -> Self {
        let mut sum = Vector2::zeros();
        for point in points {
            sum += point.coords;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of at most some thousands")]
        let centre = Point2::from(sum / points.len().max(1) as f64);
        let size = points.iter().map(|point| (point - centre).norm()).fold(0.0, f64::max);
        Self { centre, size: if size > 0.0 { size } else { 1.0 } }
    }

    fn apply(&self, point: Point2<f64>) -> Point2<f64> {
        ((point - self.centre) / self.size).into()
    }

    fn undo(&self, point: Vector2<f64>) -> Point2<f64> {
        self.centre + point * self.size
    }
}

impl ThinPlate {
    /// Fits the map that takes `centres[i]` to `values[i]`; no two centres may coincide. False, and the map is not to be used,
    /// where there are fewer than three centres or the numbers overflow.
    ///
    /// Where the system is singular (collinear centres), the unknowns without a pivot are left out, which makes the map vary
    /// across the line as little as the kernel does: [`rank`](Self::rank) says so.
    ///
    /// Cost: O(n^3) in the centres.
    pub(crate) fn fit(&mut self, centres: &[Point2<f64>], values: &[Point2<f64>]) -> bool {
        debug_assert_eq!(centres.len(), values.len());
        let num_centres = centres.len();
        if num_centres < 3 {
            return false;
        }
        self.from = Scaling::of(centres);
        self.to = Scaling::of(values);
        self.centres.clear();
        self.centres.extend(centres.iter().map(|&centre| self.from.apply(centre)));
        let size = num_centres + 3;
        let centres = &self.centres;
        let values = values.iter().map(|&value| self.to.apply(value));
        let unknowns = self.solver.solve(
            size,
            |row, column| match (row < num_centres, column < num_centres) {
                (true, true) => kernel((centres[row] - centres[column]).norm_squared()),
                (true, false) => monomial(centres[row], column - num_centres),
                (false, true) => monomial(centres[column], row - num_centres),
                (false, false) => 0.0,
            },
            values,
        );
        self.weights.clear();
        self.weights.extend_from_slice(&unknowns[..num_centres]);
        self.polynomial = [0, 1, 2].map(|k| unknowns[num_centres + k]);
        self.weights.iter().chain(&self.polynomial).all(|weight| weight.iter().all(|value| value.is_finite()))
    }

    /// The image of a point.
    pub(crate) fn evaluate(&self, point: Point2<f64>) -> Point2<f64> {
        let point = self.from.apply(point);
        let mut value = self.polynomial[0] + self.polynomial[1] * point.x + self.polynomial[2] * point.y;
        for (centre, weight) in self.centres.iter().zip(&self.weights) {
            value += weight * kernel((point - centre).norm_squared());
        }
        self.to.undo(value)
    }

    /// Rank of the system; full is the number of centres plus three.
    pub(crate) fn rank(&self) -> usize {
        self.solver.rank
    }

    /// Estimate of the condition number of the system, without what its rank falls short of: the ratio of the largest to the smallest
    /// pivot.
    pub(crate) fn condition(&self) -> f64 {
        self.solver.condition
    }
}

/// `r^2 log r` from the square of `r`.
fn kernel(squared: f64) -> f64 {
    if squared > 0.0 { 0.5 * squared * squared.ln() } else { 0.0 }
}

fn monomial(point: Point2<f64>, index: usize) -> f64 {
    match index {
        0 => 1.0,
        1 => point.x,
        _ => point.y,
    }
}

/// Solves square systems by a QR factorisation with column pivoting, in memory of its own.
#[derive(Debug, Default)]
struct Solver {
    /// Column by column.
    matrix: Vec<f64>,
    reflections: Vec<f64>,
    sides: Vec<f64>,
    order: Vec<usize>,
    inverse: Vec<usize>,
    unknowns: Vec<Vector2<f64>>,
    memory: Memory,
    rank: usize,
    condition: f64,
}

impl Solver {
    /// Solves for two right-hand sides; rows without a value have zero. Unknowns without a pivot become zero.
    fn solve(
        &mut self,
        size: usize,
        entry: impl Fn(usize, usize) -> f64,
        values: impl Iterator<Item = Point2<f64>>,
    ) -> &[Vector2<f64>] {
        self.matrix.clear();
        self.matrix.extend((0..size * size).map(|slot| entry(slot % size, slot / size)));
        self.sides.clear();
        self.sides.resize(2 * size, 0.0);
        for (row, value) in values.enumerate() {
            self.sides[row] = value.x;
            self.sides[size + row] = value.y;
        }
        self.order.resize(size, 0);
        self.inverse.resize(size, 0);
        let block = recommended_block_size::<f64>(size, size);
        self.reflections.clear();
        self.reflections.resize(block * size, 0.0);
        let stack =
            self.memory
                .stack(qr_in_place_scratch::<usize, f64>(size, size, block, Par::Seq, faer::Spec::default()).or(
                    apply_block_householder_sequence_transpose_on_the_left_in_place_scratch::<f64>(size, block, 2),
                ));
        qr_in_place(
            MatMut::from_column_major_slice_mut(&mut self.matrix, size, size),
            MatMut::from_column_major_slice_mut(&mut self.reflections, block, size),
            &mut self.order,
            &mut self.inverse,
            Par::Seq,
            stack,
            faer::Spec::default(),
        );
        let upper = MatRef::from_column_major_slice(&self.matrix, size, size);
        apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj(
            upper,
            MatRef::from_column_major_slice(&self.reflections, block, size),
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.sides, size, 2),
            Par::Seq,
            stack,
        );
        let pivot = |k: usize| upper[(k, k)].abs();
        self.rank = (0..size).take_while(|&k| pivot(k) > pivot(0) * RANK_TOLERANCE).count();
        self.condition = if self.rank > 0 { pivot(0) / pivot(self.rank - 1) } else { f64::INFINITY };
        self.unknowns.clear();
        self.unknowns.resize(size, Vector2::zeros());
        for row in (0..self.rank).rev() {
            let mut rest = Vector2::new(self.sides[row], self.sides[size + row]);
            for column in row + 1..self.rank {
                rest -= self.unknowns[self.order[column]] * upper[(row, column)];
            }
            self.unknowns[self.order[row]] = rest / upper[(row, row)];
        }
        &self.unknowns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: u32) -> Vec<Point2<f64>> {
        (0..count)
            .map(|k| {
                let angle = f64::from(k) / f64::from(count) * std::f64::consts::TAU;
                Point2::new(3.0 + 0.01 * angle.cos(), 5.0 + 0.01 * angle.sin())
            })
            .collect()
    }

    #[test]
    fn reproduces_an_affine_map_everywhere() {
        let map = |p: Point2<f64>| Point2::new(2.0 - p.x + 0.5 * p.y, 0.3 * p.x + p.y);
        let centres = ring(7);
        let values: Vec<_> = centres.iter().copied().map(map).collect();
        let mut plate = ThinPlate::default();
        assert!(plate.fit(&centres, &values));
        assert_eq!(plate.rank(), 10);
        assert!(plate.condition() > 1.0 && plate.condition() < 1e4, "{}", plate.condition());
        for point in [Point2::new(3.0, 5.0), Point2::new(3.02, 4.97)] {
            assert!((plate.evaluate(point) - map(point)).norm() < 1e-12);
        }
    }

    #[test]
    fn interpolates_a_bent_map_at_its_centres() {
        let map = |p: Point2<f64>| Point2::new(p.x + 8.0 * (p.y - 5.0).powi(2), p.y);
        let centres = ring(20);
        let values: Vec<_> = centres.iter().copied().map(map).collect();
        let mut plate = ThinPlate::default();
        assert!(plate.fit(&centres, &values));
        for (&centre, value) in centres.iter().zip(&values) {
            assert!((plate.evaluate(centre) - value).norm() < 1e-12);
        }
    }

    #[test]
    fn says_that_collinear_centres_are_rank_deficient() {
        let centres: Vec<_> = (0..6).map(|k| Point2::new(f64::from(k), 2.0 * f64::from(k))).collect();
        let mut plate = ThinPlate::default();
        assert!(plate.fit(&centres, &centres));
        assert_eq!(plate.rank(), 8);
        for &centre in &centres {
            assert!((plate.evaluate(centre) - centre).norm() < 1e-9);
        }
        assert!(!plate.fit(&centres[..2], &centres[..2]));
    }
}
