//! The thin-plate kernel `r^2 log r`, several centres at a time: most of the time of a fit goes into its logarithms.
//!
//! Vectorised or not, the operations and their order are the same, none of them fused: so the answer does not depend on
//! the processor.

use nalgebra::{Point2, Vector2};

use crate::simd::{InstructionSet, Task, dispatch};

/// Centres that go through the kernel together. The loops over them have no fixed length, or the compiler would unroll
/// instead of vectorising them.
const CHUNK: usize = 64;
/// Number of partial sums, so that a vector of them can be added at once.
const LANES: usize = 4;
/// Bits of the root of 1/2: mantissas lie between it and the root of 2, so that their logarithms are small.
const LEAST_MANTISSA: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
const ONE: u64 = 1f64.to_bits();
const FRACTION: u64 = (1 << 52) - 1;
/// A small whole number in the last bits of this one adds itself to the value.
const TWO_TO_52: f64 = 4_503_599_627_370_496.0;

/// `r^2 log r` from the square of `r`; zero for zero.
///
/// With `r^2 = 2^e m` and `f = (m - 1) / (m + 1)`, `log r^2 = e log 2 + 2 (f + f^3/3 + f^5/5 + ...)`, `|f| < 0.172`:
/// ten terms are exact to the last bit or two. The standard library's logarithm is a call, which keeps the loop round
/// it from being vectorised.
#[inline(always)]
fn kernel(squared: f64) -> f64 {
    let shifted = squared.to_bits().wrapping_add(ONE - LEAST_MANTISSA);
    let mantissa = f64::from_bits((shifted & FRACTION) + LEAST_MANTISSA);
    let exponent = f64::from_bits((shifted >> 52) | TWO_TO_52.to_bits()) - (TWO_TO_52 + 1023.0);
    let f = (mantissa - 1.0) / (mantissa + 1.0);
    let square = f * f;
    let mut series = 1.0 / 19.0;
    for odd in [17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        series = series * square + 1.0 / odd;
    }
    squared * (0.5 * std::f64::consts::LN_2 * exponent + f * series)
}

/// Centres with two weights each, padded with centres of weight zero to whole [`LANES`].
#[derive(Debug, Default)]
pub(crate) struct WeightedCentres {
    places: [Vec<f64>; 2],
    /// One for each coordinate of the value.
    weights: [Vec<f64>; 2],
}

impl WeightedCentres {
    /// Takes centres, all of weight zero.
    pub(crate) fn set(&mut self, centres: &[Point2<f64>]) {
        let size = centres.len().next_multiple_of(LANES);
        for (axis, places) in self.places.iter_mut().enumerate() {
            places.clear();
            places.extend(centres.iter().map(|centre| centre[axis]));
            places.resize(size, 0.0);
        }
        for weights in &mut self.weights {
            weights.clear();
            weights.resize(size, 0.0);
        }
    }

    /// Gives the centres weights, one for each.
    pub(crate) fn weigh(&mut self, weights: &[Vector2<f64>]) {
        for (axis, slots) in self.weights.iter_mut().enumerate() {
            for (slot, weight) in slots.iter_mut().zip(weights) {
                *slot = weight[axis];
            }
        }
    }

    /// Replaces points by the weighted sums of all kernels there.
    pub(crate) fn sums(&self, points: &mut [Point2<f64>]) {
        dispatch(Sums { centres: self, points });
    }

    /// Writes the kernels of all centres at a point, in the order of the centres.
    pub(crate) fn row(&self, point: Point2<f64>, row: &mut [f64]) {
        dispatch(Row { centres: self, point, row });
    }
}

/// Writes the kernels at a point of as many centres as there are values.
#[inline(always)]
fn kernels(point: Point2<f64>, xs: &[f64], ys: &[f64], values: &mut [f64]) {
    for ((value, x), y) in values.iter_mut().zip(xs).zip(ys) {
        let (x, y) = (point.x - x, point.y - y);
        *value = kernel(x * x + y * y);
    }
}

struct Sums<'a> {
    centres: &'a WeightedCentres,
    points: &'a mut [Point2<f64>],
}

impl Task for Sums<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, _: S) {
        let WeightedCentres { places: [xs, ys], weights } = self.centres;
        let mut buffer = [0.0; CHUNK];
        for point in self.points {
            let mut sums = [[0.0; LANES]; 2];
            for start in (0..xs.len()).step_by(CHUNK) {
                let end = (start + CHUNK).min(xs.len());
                let values = &mut buffer[..end - start];
                kernels(*point, &xs[start..end], &ys[start..end], values);
                for (sums, weights) in sums.iter_mut().zip(weights) {
                    for (values, weights) in values.chunks_exact(LANES).zip(weights[start..end].chunks_exact(LANES)) {
                        for lane in 0..LANES {
                            sums[lane] += weights[lane] * values[lane];
                        }
                    }
                }
            }
            let [x, y] = sums.map(|lanes| lanes.iter().sum());
            *point = Point2::new(x, y);
        }
    }
}

struct Row<'a> {
    centres: &'a WeightedCentres,
    point: Point2<f64>,
    row: &'a mut [f64],
}

impl Task for Row<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, _: S) {
        kernels(self.point, &self.centres.places[0], &self.centres.places[1], self.row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernel_over_all_magnitudes_agrees_with_standard_logarithm() {
        assert!(kernel(0.0).abs() < f64::MIN_POSITIVE);
        let mut worst: f64 = 0.0;
        for k in 0..20_000 {
            let squared = 10f64.powf(f64::from(k) * 0.03 - 300.0);
            let expected = 0.5 * squared * squared.ln();
            let found = kernel(squared);
            // Near 1 the logarithm is small against its argument: there the error is one of the argument.
            worst = worst.max((found - expected).abs() / (expected.abs() + squared));
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
        assert!(kernel(f64::NAN).is_nan() && kernel(f64::INFINITY).is_infinite());
    }

    #[test]
    fn kernel_sums_over_centres_that_do_not_fill_all_lanes_agree_with_rows() {
        let centres: Vec<_> = (0..135).map(|k| Point2::new(f64::from(k), 0.5 * f64::from(k * k))).collect();
        let weights: Vec<_> = (0..135).map(|k| Vector2::new(1.0 - f64::from(k), 0.1 * f64::from(k))).collect();
        let mut weighted = WeightedCentres::default();
        weighted.set(&centres);
        weighted.weigh(&weights);
        let point = Point2::new(3.0, 4.5);
        let mut row = [f64::NAN; 135];
        weighted.row(point, &mut row);
        let mut expected = Vector2::zeros();
        for ((centre, weight), entry) in centres.iter().zip(&weights).zip(row) {
            let squared = (point - centre).norm_squared();
            let value = if squared > 0.0 { 0.5 * squared * squared.ln() } else { 0.0 };
            assert!((entry - value).abs() <= 1e-15 * squared * 10.0);
            expected += weight * value;
        }
        let mut sums = [point; 2];
        weighted.sums(&mut sums);
        for sum in sums {
            assert!((sum.coords - expected).norm() < 1e-12 * expected.norm());
        }
    }
}
