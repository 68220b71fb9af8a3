//! The projection of a picture.

use nalgebra::{Matrix3, Point3, Vector3};

/// A parallel projection of a bounding box, seen from a little above one of its corners. The shortest side of the box
/// is taken for its height, since most cloth lies flat.
#[derive(Clone, Debug)]
pub struct View {
    /// Rows: right, up, towards the viewer.
    axes: Matrix3<f64>,
    /// The place in the middle of the picture, in the coordinates of `axes`.
    centre: Vector3<f64>,
    /// Pixels per metre.
    scale: f64,
    width: usize,
    height: usize,
}

/// Angle about the height of the box, in radians.
const AZIMUTH: f64 = -0.45;
/// Angle above the horizon, in radians.
const ELEVATION: f64 = 0.65;
/// Part of the picture that stays empty on each side.
const MARGIN: f64 = 0.05;

impl View {
    /// A view of all `positions`, in a picture of `width` x `height` pixels.
    #[must_use]
    pub fn of(positions: &[Point3<f64>], width: usize, height: usize) -> Self {
        Self::from_direction(positions, AZIMUTH, ELEVATION, width, height)
    }

    /// As [`of`](Self::of), from another direction: angle round the height of the box, and above the horizon, in
    /// radians.
    #[must_use]
    pub fn from_direction(
        positions: &[Point3<f64>],
        azimuth: f64,
        elevation: f64,
        width: usize,
        height: usize,
    ) -> Self {
        let axes = axes(positions, azimuth, elevation);
        let mut view = Self { axes, centre: Vector3::zeros(), scale: 1.0, width, height };
        let turned = positions.iter().map(|position| view.turn(position.coords));
        let (low, high) = bounds(turned);
        if low.x <= high.x {
            view.centre = (low + high) / 2.0;
            let size = high - low;
            let [across, up] = view.size().map(|pixels| pixels * (1.0 - 2.0 * MARGIN));
            let fit = (across / size.x).min(up / size.y);
            view.scale = if fit.is_finite() { fit } else { 1.0 };
        }
        view
    }

    /// The same, drawn smaller and lower, so that so many pixels stay free at the top.
    #[must_use]
    pub fn below(mut self, pixels: usize) -> Self {
        let [_, height] = self.size();
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels")]
        let free = pixels.min(self.height) as f64;
        self.scale *= 1.0 - free / height;
        self.centre.y += if self.scale > 0.0 { free / 2.0 / self.scale } else { 0.0 };
        self
    }

    /// How many pixels a metre across the line of sight takes.
    #[must_use]
    pub fn pixels_per_metre(&self) -> f64 {
        self.scale
    }

    /// Pixels from left to right.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// A direction in the viewer's axes: right, up, towards the viewer.
    pub(super) fn turn(&self, direction: Vector3<f64>) -> Vector3<f64> {
        self.axes * direction
    }

    /// A place in samples from the left and from the top; the third coordinate is the nearness, also in samples.
    pub(super) fn project(&self, position: Point3<f64>, samples: usize) -> Point3<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a handful of samples")]
        let samples = samples as f64;
        let seen = (self.turn(position.coords) - self.centre) * self.scale;
        let [width, height] = self.size();
        Point3::new(seen.x + width / 2.0, height / 2.0 - seen.y, seen.z) * samples
    }

    fn size(&self) -> [f64; 2] {
        #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels")]
        let size = [self.width as f64, self.height as f64];
        size
    }
}

fn bounds(points: impl Iterator<Item = Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points.fold(empty, |(low, high), point| (low.inf(&point), high.sup(&point)))
}

fn axes(positions: &[Point3<f64>], azimuth: f64, elevation: f64) -> Matrix3<f64> {
    let (low, high) = bounds(positions.iter().map(|position| position.coords));
    let size = high - low;
    // Of equally short sides the last one, so that z is the height of a cube.
    let thinnest = (0..3).fold(2, |best, axis| if size[axis] < size[best] { axis } else { best });
    let height = Vector3::ith(thinnest, 1.0);
    let east = Vector3::ith((thinnest + 1) % 3, 1.0);
    let north = height.cross(&east);
    let ahead = north * azimuth.cos() + east * azimuth.sin();
    let right = ahead.cross(&height);
    let towards = height * elevation.sin() - ahead * elevation.cos();
    let up = towards.cross(&right);
    Matrix3::from_rows(&[right.transpose(), up.transpose(), towards.transpose()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_of_a_box_shows_it_whole_and_orders_by_nearness() {
        let corners: Vec<_> = (0..8_u8)
            .map(|bits| Point3::new(f64::from(bits & 1) * 3.0, f64::from(bits >> 1 & 1), f64::from(bits >> 2) * 0.5))
            .collect();
        let view = View::of(&corners, 400, 300);
        for &corner in &corners {
            let seen = view.project(corner, 1);
            assert!((0.0..=400.0).contains(&seen.x) && (0.0..=300.0).contains(&seen.y), "{seen}");
        }
        let above = view.project(Point3::new(1.0, 0.5, 5.0), 1);
        let below = view.project(Point3::new(1.0, 0.5, 0.0), 1);
        assert!(above.z > below.z && above.y < below.y);
        assert!((view.axes.determinant() - 1.0).abs() < 1e-12, "the view is mirrored");
    }

    #[test]
    fn view_of_one_or_no_point_projects_to_finite_places() {
        assert!(View::of(&[], 10, 10).project(Point3::origin(), 1).coords.norm().is_finite());
        assert!(View::of(&[Point3::origin()], 10, 10).project(Point3::origin(), 1).coords.norm().is_finite());
    }
}
