//! Triangles to samples, with a depth buffer.

use nalgebra::{Point3, Vector3};

use super::{Colour, light, theme};

/// One corner of a triangle to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Samples from the left, from the top, and nearness.
    pub(super) screen: Point3<f64>,
    /// Unit normal as the viewer sees it.
    pub(super) normal: Vector3<f64>,
    /// 1 inside of a path, 0 outside.
    pub(super) inside: f64,
}

/// Colour and nearness of every sample, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Canvas {
    width: usize,
    height: usize,
    colours: Vec<Colour>,
    /// Minus infinity where nothing is.
    nearness: Vec<f32>,
}

impl Canvas {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let samples = width * height;
        Self { width, height, colours: vec![Colour::zeros(); samples], nearness: vec![f32::NEG_INFINITY; samples] }
    }

    pub(super) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The colour of a sample, if anything was drawn there.
    pub(super) fn sample(&self, x: usize, y: usize) -> Option<Colour> {
        let index = y * self.width + x;
        (self.nearness[index] > f32::NEG_INFINITY).then(|| self.colours[index])
    }

    pub(super) fn nearness(&self, x: usize, y: usize) -> f32 {
        self.nearness[y * self.width + x]
    }

    /// Multiplies the colour of a sample.
    pub(super) fn shade(&mut self, x: usize, y: usize, factor: f32) {
        self.colours[y * self.width + x] *= factor;
    }

    /// Lays a colour over a sample; over nothing, it makes the sample visible.
    pub(super) fn blend(&mut self, x: usize, y: usize, colour: Colour, opacity: f32) {
        let index = y * self.width + x;
        let below = self.sample(x, y).unwrap_or_else(|| theme::background(y, self.height));
        self.colours[index] = below.lerp(&colour, opacity);
        self.nearness[index] = self.nearness[index].max(f32::MIN);
    }

    /// Draws a triangle, seen from either side, with smooth shading and its sides faintly drawn, in the first of two colours
    /// outside of paths and in the second one inside.
    pub(super) fn triangle(&mut self, corners: [Corner; 3], [outside, inside]: [Colour; 2]) {
        let [a, b, c] = corners.map(|corner| corner.screen.coords.xy());
        let cross = |p: nalgebra::Vector2<f64>, q: nalgebra::Vector2<f64>| p.perp(&q);
        let area = cross(b - a, c - a);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        // The vertical axis points down: a positive area is clockwise, so its normal points away from the viewer.
        let back = area > 0.0;
        let sides = [(c - b).norm(), (a - c).norm(), (b - a).norm()];
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        for y in samples(low.y, high.y, self.height) {
            for x in samples(low.x, high.x, self.width) {
                let p = nalgebra::Vector2::new(centre(x), centre(y));
                let weights = [cross(c - b, p - b), cross(a - c, p - c), cross(b - a, p - a)].map(|part| part / area);
                if weights.iter().any(|&weight| weight < 0.0) {
                    continue;
                }
                let mut nearness = 0.0;
                let mut normal = Vector3::zeros();
                let mut share = 0.0;
                for (corner, weight) in corners.iter().zip(weights) {
                    nearness += corner.screen.z * weight;
                    normal += corner.normal * weight;
                    share += corner.inside * weight;
                }
                let index = y * self.width + x;
                let nearness = single(nearness);
                if nearness <= self.nearness[index] {
                    continue;
                }
                // How far from the nearest side, in samples: height of the triangle over that side times the weight.
                let to_side = (0..3).map(|k| weights[k] * area.abs() / sides[k]).fold(f64::INFINITY, f64::min);
                self.nearness[index] = nearness;
                let colour = outside.lerp(&inside, single(((share - 0.4) * 5.0).clamp(0.0, 1.0)));
                self.colours[index] = light::shade(colour, normal, back, single(to_side));
            }
        }
    }
}

/// Samples whose centres may lie between two places.
fn samples(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; limited to the picture")]
    let limit = |place: f64| (place.max(0.0) as usize).min(count);
    limit(low)..limit(high + 1.0)
}

#[expect(clippy::cast_precision_loss, reason = "pictures have some thousand samples a side")]
fn centre(sample: usize) -> f64 {
    sample as f64 + 0.5
}

#[expect(clippy::cast_possible_truncation, reason = "colours and nearness need no more than single precision")]
fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: [Colour; 2] = [Colour::new(0.5, 0.5, 0.5); 2];
    const RED: [Colour; 2] = [Colour::new(1.0, 0.5, 0.5); 2];

    fn triangle(points: [[f64; 2]; 3], nearness: f64) -> [Corner; 3] {
        points.map(|[x, y]| Corner { screen: Point3::new(x, y, nearness), normal: Vector3::z(), inside: 0.0 })
    }

    #[test]
    fn two_halves_cover_a_square_and_the_nearer_one_wins() {
        let mut canvas = Canvas::new(8, 8);
        canvas.triangle(triangle([[1.0, 1.0], [7.0, 1.0], [7.0, 7.0]], 0.0), GREY);
        canvas.triangle(triangle([[1.0, 1.0], [7.0, 7.0], [1.0, 7.0]], 0.0), GREY);
        let covered = |canvas: &Canvas| {
            (0..8).flat_map(|y| (0..8).map(move |x| (x, y))).filter(|&(x, y)| canvas.sample(x, y).is_some()).count()
        };
        assert_eq!(covered(&canvas), 36);
        let before = canvas.sample(4, 4);
        canvas.triangle(triangle([[0.0, 0.0], [8.0, 0.0], [4.0, 8.0]], -1.0), RED);
        assert_eq!(canvas.sample(4, 4), before);
        canvas.triangle(triangle([[0.0, 0.0], [8.0, 0.0], [4.0, 8.0]], 1.0), RED);
        assert_ne!(canvas.sample(4, 4), before);
    }
}
