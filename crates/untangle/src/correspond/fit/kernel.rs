//! The thin-plate kernel `r^2 log r`, several centres at a time: most of the time of a fit goes into its logarithms.
//!
//! Each instruction set does the same operations lane by lane, none of them fused: so the answer does not depend on the
//! processor.

use nalgebra::{Point2, Vector2};

use crate::{
    correspond::linalg::Row,
    simd::{F64_LANES, F64Lanes, InstructionSet, Lanes, Task, dispatch},
};

/// With `f = (m - 1) / (m + 1)`, `log m = f (2 + C0 f^2 + C1 f^4 + ...)`: the least-maximum coefficients of FreeBSD's
/// `e_log.c` (Sun Microsystems 1993), which are exact to 2^-58 for mantissas `m` between the roots of 1/2 and 2.
const LOGARITHM: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// `r^2 log r` from the square of `r`; zero for zero.
///
/// Half of `r^2 log r^2`, the logarithm by exponent and mantissa. That of the standard library is a call for each lane.
#[inline(always)]
fn kernel<L: F64Lanes>(simd: L, squared: L::Vector) -> L::Vector {
    let [exponent, mantissa] = simd.split(squared);
    let one = simd.splat(1.0);
    let f = simd.div(simd.sub(mantissa, one), simd.add(mantissa, one));
    let square = simd.mul(f, f);
    let mut series = simd.splat(0.5 * LOGARITHM[6]);
    for coefficient in [5, 4, 3, 2, 1, 0].map(|k: usize| LOGARITHM[k]) {
        series = simd.add(simd.mul(series, square), simd.splat(0.5 * coefficient));
    }
    series = simd.add(simd.mul(series, square), one);
    let whole = simd.mul(simd.splat(0.5 * std::f64::consts::LN_2), exponent);
    simd.mul(squared, simd.add(whole, simd.mul(f, series)))
}

/// Centres with two weights each, padded with centres of weight zero to whole rows of lanes.
#[derive(Debug, Default)]
pub(crate) struct WeightedCentres {
    count: usize,
    places: [Vec<Row>; 2],
    /// One for each coordinate of the value.
    weights: [Vec<Row>; 2],
}

impl WeightedCentres {
    /// Takes centres, all of weight zero.
    pub(crate) fn set(&mut self, centres: &[Point2<f64>]) {
        self.count = centres.len();
        let num_rows = centres.len().div_ceil(F64_LANES);
        for rows in self.places.iter_mut().chain(&mut self.weights) {
            rows.clear();
            rows.resize(num_rows, [0.0; F64_LANES]);
        }
        for (axis, places) in self.places.iter_mut().enumerate() {
            for (place, centre) in places.as_flattened_mut().iter_mut().zip(centres) {
                *place = centre[axis];
            }
        }
    }

    /// Gives the centres weights, one for each.
    pub(crate) fn weigh(&mut self, weights: &[Vector2<f64>]) {
        for (axis, slots) in self.weights.iter_mut().enumerate() {
            for (slot, weight) in slots.as_flattened_mut().iter_mut().zip(weights) {
                *slot = weight[axis];
            }
        }
    }

    /// Replaces points by the weighted sums of all kernels there.
    pub(crate) fn sums(&self, points: &mut [Point2<f64>]) {
        dispatch(Sums { centres: self, points });
    }

    /// Writes the matrix of the kernels of all centres at each of them, column by column, each padded with zeros to
    /// whole rows of lanes.
    pub(crate) fn matrix(&self, columns: &mut Vec<Row>) {
        columns.resize(self.count * self.places[0].len(), [0.0; F64_LANES]);
        dispatch(Matrix { centres: self, columns });
    }
}

struct Sums<'a> {
    centres: &'a WeightedCentres,
    points: &'a mut [Point2<f64>],
}

impl Task for Sums<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let simd = simd.f64();
        for point in self.points {
            let mut sums = [[0.0; F64_LANES]; 2];
            add_kernels(simd, self.centres, *point, &mut sums);
            let [x, y] = sums.map(|lanes| lanes.iter().sum());
            *point = Point2::new(x, y);
        }
    }
}

/// Sums up the weighted kernels at a point, lane by lane.
#[inline(always)]
fn add_kernels<L: F64Lanes>(simd: L, centres: &WeightedCentres, point: Point2<f64>, sums: &mut [Row; 2]) {
    let WeightedCentres { places: [xs, ys], weights: [us, vs], .. } = centres;
    let [x, y] = [simd.splat(point.x), simd.splat(point.y)];
    for first in (0..F64_LANES).step_by(L::WIDTH) {
        let [mut u, mut v] = [simd.splat(0.0); 2];
        for (((xs, ys), us), vs) in xs.iter().zip(ys).zip(us).zip(vs) {
            let value = kernel_between(simd, [x, y], [xs, ys], first);
            u = simd.add(u, simd.mul(simd.load(us, first), value));
            v = simd.add(v, simd.mul(simd.load(vs, first), value));
        }
        simd.store(u, &mut sums[0], first);
        simd.store(v, &mut sums[1], first);
    }
}

/// The kernels of some centres at a point.
#[inline(always)]
fn kernel_between<L: F64Lanes>(simd: L, [x, y]: [L::Vector; 2], [xs, ys]: [&Row; 2], first: usize) -> L::Vector {
    let [x, y] = [simd.sub(x, simd.load(xs, first)), simd.sub(y, simd.load(ys, first))];
    kernel(simd, simd.add(simd.mul(x, x), simd.mul(y, y)))
}

struct Matrix<'a> {
    centres: &'a WeightedCentres,
    columns: &'a mut [Row],
}

impl Task for Matrix<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let simd = simd.f64();
        let WeightedCentres { count, places: [xs, ys], .. } = self.centres;
        let points = xs.as_flattened().iter().zip(ys.as_flattened());
        for ((&x, &y), column) in points.zip(self.columns.chunks_exact_mut(xs.len().max(1))) {
            let point = [simd.splat(x), simd.splat(y)];
            for ((xs, ys), row) in xs.iter().zip(ys).zip(&mut *column) {
                for first in (0..F64_LANES).step_by(<S::F64 as F64Lanes>::WIDTH) {
                    simd.store(kernel_between(simd, point, [xs, ys], first), row, first);
                }
            }
            column.as_flattened_mut()[*count..].fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Portable;

    fn scalar_kernel(squared: f64) -> f64 {
        kernel(Portable.f64(), squared)
    }

    #[test]
    fn kernel_over_all_magnitudes_agrees_with_standard_logarithm() {
        assert!(scalar_kernel(0.0).abs() < f64::MIN_POSITIVE);
        let mut worst: f64 = 0.0;
        for k in 0..20_000 {
            let squared = 10f64.powf(f64::from(k) * 0.03 - 300.0);
            let expected = 0.5 * squared * squared.ln();
            let found = scalar_kernel(squared);
            // Near 1 the logarithm is small against its argument: there the error is one of the argument.
            worst = worst.max((found - expected).abs() / (expected.abs() + squared));
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
        assert!(scalar_kernel(f64::NAN).is_nan() && scalar_kernel(f64::INFINITY).is_infinite());
    }

    #[test]
    fn kernel_sums_over_centres_that_do_not_fill_all_lanes_agree_with_the_matrix() {
        let centres: Vec<_> = (0..135).map(|k| Point2::new(f64::from(k), 0.5 * f64::from(k * k))).collect();
        let weights: Vec<_> = (0..135).map(|k| Vector2::new(1.0 - f64::from(k), 0.1 * f64::from(k))).collect();
        let mut weighted = WeightedCentres::default();
        weighted.set(&centres);
        weighted.weigh(&weights);
        let mut matrix = Vec::new();
        weighted.matrix(&mut matrix);
        let columns = matrix.as_flattened().chunks_exact(136);
        assert_eq!(columns.len(), 135);
        for (point, column) in centres.iter().zip(columns) {
            let mut expected = Vector2::zeros();
            for ((centre, weight), &entry) in centres.iter().zip(&weights).zip(column) {
                let squared = (point - centre).norm_squared();
                let value = if squared > 0.0 { 0.5 * squared * squared.ln() } else { 0.0 };
                assert!((entry - value).abs() <= 1e-15 * squared * 10.0);
                expected += weight * value;
            }
            assert!(column[135].abs() < f64::MIN_POSITIVE);
            let mut sums = [*point; 2];
            weighted.sums(&mut sums);
            for sum in sums {
                assert!((sum.coords - expected).norm() < 1e-12 * expected.norm());
            }
        }
    }
}
