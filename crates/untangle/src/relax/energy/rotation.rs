//! The rotation nearest to a matrix: the orthogonal factor of its polar decomposition.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Rotation3};

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
        for odd in [Matrix3::zeros(), Matrix3::from_element(f64::NAN), Matrix3::from_element(1.0)] {
            assert!((nearest_rotation(&odd).determinant() - 1.0).abs() < 1e-9);
        }
    }
}
