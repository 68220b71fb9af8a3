//! Thin-plate spline of a map of the plane (Duchon 1977; Bookstein 1989 for maps from plane to plane).
//!
//! `d(x) = a0 + a1 x + a2 y + sum_j w_j phi(|x - c_j|)` with `phi(r) = r^2 log r`, so that `d(c_i) = v_i` and the
//! weights have no affine part (Wicke, Lanker and Gross 2006, equations 1 to 3; the matrix A there is n x 3, not n x
//! 4). Both sides are centred and scaled to unit size first: without that the condition number would depend on the unit
//! of length.

use nalgebra::{Point2, Vector2};

use super::kernel::WeightedCentres;
use crate::correspond::linalg::SaddlePoint;

/// A smooth map of the plane that takes given centres to given values.
#[derive(Debug, Default)]
pub(crate) struct ThinPlate {
    centres: Vec<Point2<f64>>,
    values: Vec<Vector2<f64>>,
    weighted: WeightedCentres,
    polynomial: [Vector2<f64>; 3],
    from: Scaling,
    to: Scaling,
    system: SaddlePoint,
}

/// Maps a set of points to mean 0 and greatest distance 1.
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
    /// Fits the map that takes `centres[i]` to `values[i]`; no two centres may coincide. False, and the map is not to
    /// be used, where there are fewer than three centres or the numbers overflow.
    ///
    /// Where the system is singular (collinear centres), the unknowns without a pivot are left out, which makes the map
    /// vary across the line as little as the kernel does: [`rank`](Self::rank) says so.
    ///
    /// Cost: O(n^3) in the centres.
    pub(crate) fn fit(&mut self, centres: &[Point2<f64>], values: &[Point2<f64>]) -> bool {
        debug_assert_eq!(centres.len(), values.len());
        if centres.len() < 3 {
            return false;
        }
        self.from = Scaling::of(centres);
        self.to = Scaling::of(values);
        self.centres.clear();
        self.centres.extend(centres.iter().map(|&centre| self.from.apply(centre)));
        self.values.clear();
        self.values.extend(values.iter().map(|&value| self.to.apply(value).coords));
        self.weighted.set(&self.centres);
        let Self { weighted, centres, values, .. } = self;
        let Some(solution) = self.system.solve(centres, values, |columns| weighted.matrix(columns)) else {
            return false;
        };
        self.polynomial = solution.polynomial;
        weighted.weigh(solution.weights);
        solution.weights.iter().chain(&solution.polynomial).all(|weight| weight.iter().all(|value| value.is_finite()))
    }

    /// The images of some points.
    pub(crate) fn evaluate_all(&self, points: &[Point2<f64>], images: &mut Vec<Point2<f64>>) {
        images.clear();
        images.extend(points.iter().map(|&point| self.from.apply(point)));
        self.weighted.sums(images);
        for (image, &point) in images.iter_mut().zip(points) {
            *image = self.finish(point, *image);
        }
    }

    /// Adds the affine part of the image of a point to that of the kernels.
    fn finish(&self, point: Point2<f64>, of_kernels: Point2<f64>) -> Point2<f64> {
        let point = self.from.apply(point);
        let affine = self.polynomial[0] + self.polynomial[1] * point.x + self.polynomial[2] * point.y;
        self.to.undo(affine + of_kernels.coords)
    }

    /// Rank of the system; full is the number of centres plus three.
    pub(crate) fn rank(&self) -> usize {
        self.system.rank()
    }

    /// Estimate of the condition number of the kernels on weights without an affine part, as far as their rank goes:
    /// the ratio of the largest to the smallest pivot.
    pub(crate) fn condition(&self) -> f64 {
        self.system.condition()
    }
}

#[cfg(test)]
impl ThinPlate {
    /// The image of a point.
    pub(crate) fn evaluate(&self, point: Point2<f64>) -> Point2<f64> {
        let mut images = Vec::new();
        self.evaluate_all(&[point], &mut images);
        images[0]
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
    fn thin_plate_of_affine_map_reproduces_it_everywhere() {
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
    fn thin_plate_of_bent_map_interpolates_its_centres() {
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
    fn thin_plate_of_collinear_centres_is_rank_deficient() {
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
