//! Similarities of the plane without reflection: how a chart goes on where it was cut open.

use nalgebra::{Point2, Vector2};

/// `z -> turn z + shift`, with vectors as complex numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    turn: Vector2<f64>,
    shift: Vector2<f64>,
}

impl Motion {
    /// What leaves everything where it is.
    pub(crate) const IDENTITY: Self = Self { turn: Vector2::new(1.0, 0.0), shift: Vector2::new(0.0, 0.0) };

    /// The motion that takes two points to two others; nothing if one of the pairs is a single point.
    pub(crate) fn taking(from: [Point2<f64>; 2], to: [Point2<f64>; 2]) -> Option<Self> {
        let (side, image) = (from[1] - from[0], to[1] - to[0]);
        let squared = side.norm_squared();
        if squared <= 0.0 || image.norm_squared() <= 0.0 {
            return None;
        }
        let turn = Vector2::new(side.dot(&image), side.perp(&image)) / squared;
        Some(Self { turn, shift: to[0].coords - times(turn, from[0].coords) })
    }

    /// The shift that takes one point to another.
    pub(crate) fn shifting(from: Point2<f64>, to: Point2<f64>) -> Self {
        Self { shift: to - from, ..Self::IDENTITY }
    }

    /// The best turn and shift, without a change of scale, that take the points of pairs to their partners, and the root of the mean squared
    /// distance that is left; nothing without a pair.
    pub(crate) fn fit(pairs: impl Iterator<Item = [Point2<f64>; 2]> + Clone) -> Option<(Self, f64)> {
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
        let mut turn = Vector2::zeros();
        for [a, b] in pairs.clone() {
            let (a, b) = (a.coords - from, b.coords - to);
            turn += Vector2::new(a.dot(&b), a.perp(&b));
        }
        let turn = turn.try_normalize(0.0).unwrap_or_else(Vector2::x);
        let motion = Self { turn, shift: to - times(turn, from) };
        let squared: f64 = pairs.map(|[a, b]| (motion.apply(a) - b).norm_squared()).sum();
        Some((motion, (squared / count).sqrt()))
    }

    /// The image of a point.
    pub(crate) fn apply(&self, point: Point2<f64>) -> Point2<f64> {
        Point2::from(times(self.turn, point.coords) + self.shift)
    }

    /// First `other`, then this one.
    pub(crate) fn after(&self, other: &Self) -> Self {
        Self { turn: times(self.turn, other.turn), shift: times(self.turn, other.shift) + self.shift }
    }

    /// The motion that undoes this one.
    pub(crate) fn inverse(&self) -> Self {
        let turn = Vector2::new(self.turn.x, -self.turn.y) / self.turn.norm_squared();
        Self { turn, shift: -times(turn, self.shift) }
    }

    /// The motion done `count` times, backwards if negative.
    pub(crate) fn times(&self, count: i32) -> Self {
        let step = if count < 0 { self.inverse() } else { *self };
        (0..count.unsigned_abs()).fold(Self::IDENTITY, |sum, _| step.after(&sum))
    }
}

fn times(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_compose_and_are_undone() {
        let (p, q) = (Point2::new(1.0, 2.0), Point2::new(-0.5, 0.25));
        let motion = Motion::taking([p, q], [Point2::new(3.0, 0.0), Point2::new(3.0, 5.0)]).unwrap();
        assert!((motion.apply(q) - Point2::new(3.0, 5.0)).norm() < 1e-12);
        assert!((motion.inverse().apply(motion.apply(p)) - p).norm() < 1e-12);
        assert!((motion.times(3).apply(p) - motion.apply(motion.apply(motion.apply(p)))).norm() < 1e-9);
        assert!((motion.times(-2).after(&motion.times(2)).apply(p) - p).norm() < 1e-12);
        assert_eq!(Motion::taking([p, p], [p, q]), None);
        let pairs = [p, q, Point2::new(7.0, 1.0)].map(|from| [from, Point2::new(2.0 - from.y, from.x)]);
        let (found, rest) = Motion::fit(pairs.into_iter()).unwrap();
        assert!(rest < 1e-12 && (found.apply(p) - Point2::new(0.0, 1.0)).norm() < 1e-12);
    }
}
