//! Triangles to samples.

use nalgebra::{Point3, Vector2, Vector3};

use super::{
    canvas::{Canvas, centre, samples},
    light,
    theme::{Colour, single},
};

/// One corner of a triangle to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Samples from the left, from the top, and nearness.
    pub(super) screen: Point3<f64>,
    /// Unit normal in the viewer's axes.
    pub(super) normal: Vector3<f64>,
    /// 1 inside of a path, 0 outside.
    pub(super) inside: f64,
}

/// Draws a triangle with smooth shading, seen from either side, and with faint sides; in the first colour outside of
/// paths, in the second inside.
pub(super) fn triangle(canvas: &mut Canvas, corners: [Corner; 3], [outside, inside]: [Colour; 2]) {
    let [a, b, c] = corners.map(|corner| corner.screen.coords.xy());
    let cross = |p: Vector2<f64>, q: Vector2<f64>| p.perp(&q);
    let area = cross(b - a, c - a);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    // The vertical axis points down: a positive area is clockwise, so its normal points away from the viewer.
    let back = area > 0.0;
    let sides = [(c - b).norm(), (a - c).norm(), (b - a).norm()];
    let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
    let [width, height] = canvas.size();
    for y in samples(low.y, high.y, height) {
        for x in samples(low.x, high.x, width) {
            let p = Vector2::new(centre(x), centre(y));
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
            canvas.draw(x, y, single(nearness), || {
                // Distance to the nearest side, in samples: height of the triangle over that side times the weight.
                let to_side = (0..3).map(|k| weights[k] * area.abs() / sides[k]).fold(f64::INFINITY, f64::min);
                let colour = outside.lerp(&inside, single(((share - 0.4) * 5.0).clamp(0.0, 1.0)));
                light::shade(colour, normal, back, single(to_side))
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: [Colour; 2] = [Colour::new(0.5, 0.5, 0.5); 2];
    const RED: [Colour; 2] = [Colour::new(1.0, 0.5, 0.5); 2];

    fn corners(points: [[f64; 2]; 3], nearness: f64) -> [Corner; 3] {
        points.map(|[x, y]| Corner { screen: Point3::new(x, y, nearness), normal: Vector3::z(), inside: 0.0 })
    }

    #[test]
    fn triangle_covers_its_samples_once_and_hides_what_is_farther() {
        let mut canvas = Canvas::new(8, 8);
        triangle(&mut canvas, corners([[1.0, 1.0], [7.0, 1.0], [7.0, 7.0]], 0.0), GREY);
        triangle(&mut canvas, corners([[1.0, 1.0], [7.0, 7.0], [1.0, 7.0]], 0.0), GREY);
        let covered = |canvas: &Canvas| {
            (0..8).flat_map(|y| (0..8).map(move |x| (x, y))).filter(|&(x, y)| canvas.sample(x, y).is_some()).count()
        };
        assert_eq!(covered(&canvas), 36);
        let before = canvas.sample(4, 4);
        triangle(&mut canvas, corners([[0.0, 0.0], [8.0, 0.0], [4.0, 8.0]], -1.0), RED);
        assert_eq!(canvas.sample(4, 4), before);
        triangle(&mut canvas, corners([[0.0, 0.0], [8.0, 0.0], [4.0, 8.0]], 1.0), RED);
        assert_ne!(canvas.sample(4, 4), before);
    }
}
