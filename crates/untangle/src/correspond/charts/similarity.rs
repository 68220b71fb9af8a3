//! Similarities of the plane without reflection: rotation, uniform scale and translation.

use nalgebra::{Point2, Vector2};

use crate::geometry::{complex_product, complex_quotient, conjugate_product};

/// `z -> rotation z + translation`, with vectors as complex numbers; `rotation` carries the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Similarity {
    rotation: Vector2<f64>,
    translation: Vector2<f64>,
}

impl Similarity {
    /// Maps each point to itself.
    pub(crate) const IDENTITY: Self = Self { rotation: Vector2::new(1.0, 0.0), translation: Vector2::new(0.0, 0.0) };

    /// The similarity that maps one segment to another; nothing if one of them is a single point.
    pub(crate) fn between_segments(from: [Point2<f64>; 2], to: [Point2<f64>; 2]) -> Option<Self> {
        let (side, image) = (from[1] - from[0], to[1] - to[0]);
        if side.norm_squared() <= 0.0 || image.norm_squared() <= 0.0 {
            return None;
        }
        let rotation = complex_quotient(image, side);
        Some(Self { rotation, translation: to[0].coords - complex_product(rotation, from[0].coords) })
    }

    /// The translation that maps one point to another.
    pub(crate) fn between_points(from: Point2<f64>, to: Point2<f64>) -> Self {
        Self { translation: to - from, ..Self::IDENTITY }
    }

    /// The rotation and translation, without a change of scale, that map the first points of pairs to the second in the
    /// sense of least squares (orthogonal Procrustes problem, Schönemann 1966), and the root of the mean squared
    /// distance that remains; nothing without a pair.
    pub(crate) fn fit_rigid(pairs: impl Iterator<Item = [Point2<f64>; 2]> + Clone) -> Option<(Self, f64)> {
        let (mut count, mut from, mut to) = (0.0, Vector2::zeros(), Vector2::zeros());
        for [a, b] in pairs.clone() {
            count += 1.0;
            from += a.coords;
            to += b.coords;
        }
        if count <= 0.0 {
            return None;
        }
        (from, to) = (from / count, to / count);
        let mut rotation = Vector2::zeros();
        for [a, b] in pairs.clone() {
            rotation += conjugate_product(a.coords - from, b.coords - to);
        }
        let rotation = rotation.try_normalize(0.0).unwrap_or_else(Vector2::x);
        let fitted = Self { rotation, translation: to - complex_product(rotation, from) };
        let squared: f64 = pairs.map(|[a, b]| (fitted.apply(a) - b).norm_squared()).sum();
        Some((fitted, (squared / count).sqrt()))
    }

    /// The image of a point.
    pub(crate) fn apply(&self, point: Point2<f64>) -> Point2<f64> {
        Point2::from(complex_product(self.rotation, point.coords) + self.translation)
    }

    /// The composition: first `other`, then this one.
    pub(crate) fn after(&self, other: &Self) -> Self {
        Self {
            rotation: complex_product(self.rotation, other.rotation),
            translation: complex_product(self.rotation, other.translation) + self.translation,
        }
    }

    /// The inverse map.
    pub(crate) fn inverse(&self) -> Self {
        let rotation = Vector2::new(self.rotation.x, -self.rotation.y) / self.rotation.norm_squared();
        Self { rotation, translation: -complex_product(rotation, self.translation) }
    }

    /// This map composed with itself to `exponent` factors; the inverse for negative exponents.
    pub(crate) fn power(&self, exponent: i32) -> Self {
        let step = if exponent < 0 { self.inverse() } else { *self };
        (0..exponent.unsigned_abs()).fold(Self::IDENTITY, |product, _| step.after(&product))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Point2<f64> = Point2::new(1.0, 2.0);
    const Q: Point2<f64> = Point2::new(-0.5, 0.25);

    #[test]
    fn similarity_between_segments_maps_ends_and_composes_with_its_powers() {
        let map = Similarity::between_segments([P, Q], [Point2::new(3.0, 0.0), Point2::new(3.0, 5.0)]).unwrap();
        assert!((map.apply(Q) - Point2::new(3.0, 5.0)).norm() < 1e-12);
        assert!((map.inverse().apply(map.apply(P)) - P).norm() < 1e-12);
        assert!((map.power(3).apply(P) - map.apply(map.apply(map.apply(P)))).norm() < 1e-9);
        assert!((map.power(-2).after(&map.power(2)).apply(P) - P).norm() < 1e-12);
    }

    #[test]
    fn similarity_between_point_and_segment_is_none() {
        assert_eq!(Similarity::between_segments([P, P], [P, Q]), None);
        assert_eq!(Similarity::between_segments([P, Q], [Q, Q]), None);
    }

    #[test]
    fn similarity_fit_to_rotated_points_leaves_no_rest() {
        let pairs = [P, Q, Point2::new(7.0, 1.0)].map(|from| [from, Point2::new(2.0 - from.y, from.x)]);
        let (found, rest) = Similarity::fit_rigid(pairs.into_iter()).unwrap();
        assert!(rest < 1e-12 && (found.apply(P) - Point2::new(0.0, 1.0)).norm() < 1e-12);
    }
}
