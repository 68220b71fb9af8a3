//! The rotation nearest to a matrix: the orthogonal factor of its polar decomposition.

use arrayvec::ArrayVec;
use nalgebra::{Matrix2, Matrix3, Matrix3x2, Rotation3};

use crate::simd::{F64_LANES, F64Lanes, InstructionSet, Lanes, Task, dispatch};

/// Newton's iteration for the polar factor: the least determinant at which it goes on, its longest run, and the change
/// at which it ends.
const MIN_DETERMINANT: f64 = 1e-3;
const MAX_NEWTON_STEPS: usize = 12;
const LAST_CHANGE: f64 = 1e-7;

/// The rotation nearest to a matrix; the identity for a matrix without any direction.
///
/// The matrices here come from sheets and are almost singular. The matrix of cofactors has the same singular vectors,
/// and is large where they are small: the sum of both has the same nearest rotation, and is well enough conditioned for
/// Newton's iteration (Higham 1986). Where that fails, the singular value decomposition decides, which takes several
/// times as long.
pub(crate) fn nearest_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let scaled = matrix / matrix.norm();
    let mut rotation = scaled + cofactors(&scaled);
    for _ in 0..MAX_NEWTON_STEPS {
        let cofactors = cofactors(&rotation);
        let determinant = rotation.column(0).dot(&cofactors.column(0));
        if determinant.is_nan() || determinant < MIN_DETERMINANT {
            break;
        }
        let scale = (cofactors.norm() / (determinant * rotation.norm())).sqrt();
        let next = rotation * (0.5 * scale) + cofactors * (0.5 / (scale * determinant));
        let change = (next - rotation).norm();
        rotation = next;
        // The error is the square of the last change.
        if change < LAST_CHANGE {
            return rotation;
        }
    }
    nearest_rotation_by_svd(matrix)
}

fn cofactors(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let [a, b, c] = [0, 1, 2].map(|column| matrix.column(column));
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}

/// Turns matrices into the rotations nearest to them: the same bits as [`nearest_rotation`] gives one by one.
pub(super) fn turn_into_nearest_rotations<'a>(matrices: impl Iterator<Item = &'a mut Matrix3<f64>>) {
    let mut four = ArrayVec::<&mut Matrix3<f64>, F64_LANES>::new();
    for matrix in matrices {
        four.push(matrix);
        if four.is_full() {
            turn_four(&mut four);
            four.clear();
        }
    }
    turn_four(&mut four);
}

fn turn_four(matrices: &mut [&mut Matrix3<f64>]) {
    // Lanes without a matrix, or with one without a direction, have the identity.
    let mut entries = [[0.0; F64_LANES]; 9];
    let mut with_direction = 0;
    for lane in 0..F64_LANES {
        let matrix = matrices.get(lane).filter(|matrix| matrix.norm() > 0.0 && matrix.norm().is_finite());
        with_direction |= u32::from(matrix.is_some()) << lane;
        let identity = Matrix3::identity();
        let matrix = matrix.map_or(&identity, |matrix| &**matrix);
        for (entry, value) in entries.iter_mut().zip(matrix.iter()) {
            entry[lane] = *value;
        }
    }
    let mut converged = 0;
    dispatch(PolarNewton { entries: &mut entries, converged: &mut converged });
    for (lane, matrix) in matrices.iter_mut().enumerate() {
        **matrix = if with_direction & converged & (1 << lane) == 0 {
            nearest_rotation_by_svd(matrix)
        } else {
            Matrix3::from_iterator(entries.iter().map(|entry| entry[lane]))
        };
    }
}

/// Newton's iteration of [`nearest_rotation`] for four matrices, column by column.
struct PolarNewton<'a> {
    entries: &'a mut [[f64; F64_LANES]; 9],
    /// One bit for each lane.
    converged: &'a mut u32,
}

impl Task for PolarNewton<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let simd = simd.f64();
        for first in (0..F64_LANES).step_by(S::F64::WIDTH) {
            let mut matrix = [[simd.splat(0.0); 3]; 3];
            for k in 0..9 {
                matrix[k / 3][k % 3] = simd.load(&self.entries[k], first);
            }
            let (rotation, bits) = polar_newton(simd, matrix);
            *self.converged |= bits << first;
            for k in 0..9 {
                simd.store(rotation[k / 3][k % 3], &mut self.entries[k], first);
            }
        }
    }
}

/// Three columns.
type Columns<L> = [[<L as Lanes>::Vector; 3]; 3];

/// The polar factors, and one bit for each lane in which the iteration converged. Operations are in the order of
/// [`nearest_rotation`].
#[inline(always)]
fn polar_newton<L: F64Lanes>(simd: L, matrix: Columns<L>) -> (Columns<L>, u32) {
    let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
    let norm = lanes_norm(simd, matrix);
    let mut rotation = matrix;
    for k in 0..9 {
        rotation[k / 3][k % 3] = simd.div(matrix[k / 3][k % 3], norm);
    }
    let first_cofactors = lanes_cofactors(simd, rotation);
    for k in 0..9 {
        rotation[k / 3][k % 3] = simd.add(rotation[k / 3][k % 3], first_cofactors[k / 3][k % 3]);
    }
    let (mut goes_on, mut converged) = (one, 0);
    for _ in 0..MAX_NEWTON_STEPS {
        let cofactors = lanes_cofactors(simd, rotation);
        let determinant = simd.dot(rotation[0], cofactors[0]);
        goes_on = simd.select(simd.sub(simd.splat(MIN_DETERMINANT), determinant), zero, goes_on);
        let determinant = simd.select(goes_on, determinant, one);
        let scale = simd.sqrt(simd.div(lanes_norm(simd, cofactors), simd.mul(determinant, lanes_norm(simd, rotation))));
        let half = simd.splat(0.5);
        let (own, other) = (simd.mul(half, scale), simd.div(half, simd.mul(scale, determinant)));
        let (mut next, mut change) = (rotation, rotation);
        for k in 0..9 {
            let (column, row) = (k / 3, k % 3);
            let (before, cofactor) = (rotation[column][row], cofactors[column][row]);
            next[column][row] = simd.add(simd.mul(before, own), simd.mul(cofactor, other));
            change[column][row] = simd.sub(next[column][row], before);
            rotation[column][row] = simd.select(goes_on, next[column][row], before);
        }
        let is_last = simd.sub(simd.splat(LAST_CHANGE), lanes_norm(simd, change));
        converged |= simd.gt_zero_mask(goes_on) & simd.gt_zero_mask(is_last);
        goes_on = simd.select(is_last, zero, goes_on);
        if simd.gt_zero_mask(goes_on) == 0 {
            break;
        }
    }
    (rotation, converged)
}

#[inline(always)]
fn lanes_cofactors<L: Lanes>(simd: L, [a, b, c]: Columns<L>) -> Columns<L> {
    [simd.cross(b, c), simd.cross(c, a), simd.cross(a, b)]
}

#[inline(always)]
fn lanes_norm<L: F64Lanes>(simd: L, [a, b, c]: Columns<L>) -> L::Vector {
    simd.sqrt(simd.add(simd.add(simd.dot(a, a), simd.dot(b, b)), simd.dot(c, c)))
}

fn nearest_rotation_by_svd(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    let (Some(u), Some(vt)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    let mut rotation = u * vt;
    if rotation.determinant() < 0.0 {
        let mut flipped = u;
        flipped.column_mut(2).neg_mut();
        rotation = flipped * vt;
    }
    if rotation.iter().all(|value| value.is_finite()) { rotation } else { Rotation3::identity().into_inner() }
}

/// The 3 x 2 matrix with orthonormal columns that is nearest to a matrix; zero for a matrix without a direction.
pub(super) fn nearest_orthonormal(matrix: &Matrix3x2<f64>) -> Matrix3x2<f64> {
    let square = matrix.transpose() * matrix;
    let (root, trace) = (square.determinant().max(0.0).sqrt(), square.trace());
    if root > 1e-9 * trace {
        // The inverse of the square root of a symmetric 2 x 2 matrix, by Cayley and Hamilton.
        let root_of_trace = (trace + 2.0 * root).sqrt();
        let inverse = (Matrix2::identity() * (trace + root) - square) / (root * root_of_trace);
        return matrix * inverse;
    }
    let svd = matrix.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) if (u * v_t).iter().all(|value| value.is_finite()) => u * v_t,
        _ => Matrix3x2::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn nearest_rotation_of_almost_singular_matrices_agrees_with_svd() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for thickness in [1.0, 1e-3, 1e-9, 0.0] {
            for _ in 0..200 {
                let mut unit = || random.random_range(-1.0..1.0);
                let turn = |a, b, c| Rotation3::new(Vector3::new(a, b, c) * 3.0).into_inner();
                let stretch = Matrix3::from_diagonal(&Vector3::new(1.0 + 0.5 * unit(), 1.0, thickness * unit()));
                let matrix = turn(unit(), unit(), unit()) * stretch * turn(unit(), unit(), unit()) * 1e-4;
                let (newton, svd) = (nearest_rotation(&matrix), nearest_rotation_by_svd(&matrix));
                // Of a mirror image of almost equal thickness two rotations are almost as near.
                if thickness < 1.0 || matrix.determinant() > 0.0 {
                    assert!((newton - svd).norm() < 1e-9, "{thickness} {newton} {svd}");
                }
            }
        }
    }

    #[test]
    fn rotations_four_at_a_time_are_those_of_one_at_a_time_to_the_bit() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut matrices: Vec<Matrix3<f64>> = vec![Matrix3::zeros(), Matrix3::from_element(f64::NAN)];
        for thickness in [1.0, 1e-3, 1e-9, 0.0, -1.0] {
            for _ in 0..101 {
                let flat = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, thickness));
                matrices.push(flat * Matrix3::from_fn(|_, _| random.random_range(-1.0..1.0)));
                matrices.push(Matrix3::identity() * random.random_range(0.0..1.0) + flat * 1e-3);
            }
        }
        matrices.extend([
            Matrix3::from_element(1.0),
            Matrix3::from_element(f64::INFINITY),
            Matrix3::identity() * 1e-200,
        ]);
        let mut turned = matrices.clone();
        turn_into_nearest_rotations(turned.iter_mut());
        let mut by_svd = 0;
        for (matrix, turned) in matrices.iter().zip(&turned) {
            let alone = nearest_rotation(matrix);
            assert_eq!(turned.map(f64::to_bits), alone.map(f64::to_bits), "{matrix}");
            by_svd += usize::from(alone.map(f64::to_bits) == nearest_rotation_by_svd(matrix).map(f64::to_bits));
        }
        assert!(by_svd > 3 && by_svd < matrices.len() / 2, "{by_svd} of {}", matrices.len());
    }

    #[test]
    fn rotation_nearest_to_what_has_no_direction_is_one() {
        for odd in [Matrix3::zeros(), Matrix3::from_element(f64::NAN), Matrix3::from_element(1.0)] {
            assert!((nearest_rotation(&odd).determinant() - 1.0).abs() < 1e-9);
        }
    }
}
