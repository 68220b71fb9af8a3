//! Self-intersection test of a vertex star: if its projection along some direction is injective, its faces do not
//! intersect.
//!
//! Sufficient condition of Volino and Magnenat-Thalmann (1994) for a surface without self-intersection, for the faces
//! around one vertex: if every face, seen along some direction, turns the same way around the vertex, and all together
//! turn once, then the faces lie in sectors that do not overlap, so that they share the vertex and their common edges
//! alone.
//!
//! That they turn once is proven by a few parts of less than half a turn each. A closed one-ring turns a whole number
//! of times, so that less than two turns are one; an open one has to stay below one.
//!
//! All inequalities hold strictly, hence also on the perturbed input of the exact signs.

use super::one_rings::OneRing;
use crate::{
    frame::Frame,
    simd::{Lanes, Scalar},
};

/// Relative error of `x_i y_j - x_j y_i` of projected points.
///
/// With unit roundoff e, `x = m . (p - o)` is off by at most 4 e (1 + 4 e) times `|m|_1 |p - o|_max`, a product of two
/// such by 9 e, and their difference by 10 e of twice the product of the largest magnitudes.
const ROUNDING: f64 = 32.0 * (f64::EPSILON / 2.0);

/// Differences below it may come from underflow, where errors are not relative.
const FLOOR: f64 = 1e-200;

/// The test of one vertex star after the other, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct VertexStarFilter {
    spokes: Vec<[f64; 3]>,
    projected: Vec<Spoke>,
}

/// An edge from the centre to a neighbour, as seen along some direction.
#[derive(Clone, Copy, Debug)]
struct Spoke {
    x: f64,
    y: f64,
    /// Bound of the magnitudes of both coordinates before projection.
    max_abs: f64,
}

impl VertexStarFilter {
    /// Whether the faces of a vertex star are proven not to intersect beyond its centre.
    #[inline(always)]
    pub(crate) fn is_injective(&mut self, frame: &Frame, ring: OneRing<'_>) -> bool {
        self.clearance(frame, ring, left_turn_area) > 0.0
    }

    /// How far each vertex of a star may move, in metres, before its faces may intersect beyond its centre: a lower
    /// bound, positive where they are proven not to intersect now.
    #[inline(always)]
    pub(crate) fn clearance_m(&mut self, frame: &Frame, ring: OneRing<'_>) -> f64 {
        self.clearance(frame, ring, left_turn_clearance)
    }

    /// The least of all turns by a measure that is positive for a turn that is proven to be a left one.
    ///
    /// Tried are the axis nearest to the normal of the first face, the one nearest to the mean normal, and the mean
    /// normal.
    #[inline(always)]
    fn clearance(&mut self, frame: &Frame, ring: OneRing<'_>, turn: impl Fn(Spoke, Spoke) -> f64) -> f64 {
        let &[first, .., last] = ring.around else { return 0.0 };
        let closes = first == last;
        let centre: [f64; 3] = frame.position(ring.centre).into();
        self.spokes.clear();
        self.spokes.extend(ring.around.iter().map(|&vertex| Scalar.sub3(frame.position(vertex).into(), centre)));
        // Along an axis nothing needs projecting, and most cloth is smooth enough for the normal of any face to name
        // it.
        let first_normal = Scalar.cross(self.spokes[0], self.spokes[1]);
        let clearance = self.clearance_along_axis(Axis::nearest_to(first_normal), closes, &turn);
        if clearance > 0.0 {
            return clearance;
        }
        let normal = self.spokes.windows(2).fold([0.0; 3], |sum, side| {
            let normal = Scalar.cross(side[0], side[1]);
            [sum[0] + normal[0], sum[1] + normal[1], sum[2] + normal[2]]
        });
        let axis = Axis::nearest_to(normal);
        let is_tried = axis == Axis::nearest_to(first_normal);
        let clearance = if is_tried { 0.0 } else { self.clearance_along_axis(axis, closes, &turn) };
        if clearance > 0.0 { clearance } else { self.clearance_along_normal(normal, axis, closes, &turn) }
    }

    /// The same as seen along an axis.
    #[inline(always)]
    fn clearance_along_axis(&mut self, axis: Axis, closes: bool, turn: &impl Fn(Spoke, Spoke) -> f64) -> f64 {
        let [next, after] = axis.others();
        self.projected.clear();
        self.projected.extend(self.spokes.iter().map(|spoke| Spoke {
            x: spoke[next],
            y: spoke[after],
            max_abs: max_abs(spoke),
        }));
        clearance_of_turns(&self.projected, closes, turn)
    }

    /// The same as seen along a normal, to which an axis is the nearest one.
    #[inline(always)]
    fn clearance_along_normal(
        &mut self,
        normal: [f64; 3],
        axis: Axis,
        closes: bool,
        turn: &impl Fn(Spoke, Spoke) -> f64,
    ) -> f64 {
        let size = normal[axis.number].abs();
        if size == 0.0 {
            return 0.0;
        }
        let [next, _] = axis.others();
        let normal = normal.map(|coordinate| coordinate / size);
        let mut aside = [0.0; 3];
        aside[next] = 1.0;
        let along = Scalar.cross(aside, normal);
        let across = Scalar.cross(normal, along);
        // Each at most 6 in the sum of its magnitudes.
        self.projected.clear();
        self.projected.extend(self.spokes.iter().map(|spoke| Spoke {
            x: Scalar.dot(along, *spoke),
            y: Scalar.dot(across, *spoke),
            max_abs: 6.0 * max_abs(spoke),
        }));
        // The two vectors are at most sqrt(2) and sqrt(6) long, so that a point moves, seen along them, less than three
        // times as far.
        clearance_of_turns(&self.projected, closes, turn) / 3.0
    }
}

/// An axis and a direction along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Axis {
    number: usize,
    is_backwards: bool,
}

impl Axis {
    #[inline(always)]
    fn nearest_to(normal: [f64; 3]) -> Self {
        let number = (1..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        Self { number, is_backwards: normal[number] < 0.0 }
    }

    /// The other two axes, so that a turn from the first to the second is a left one.
    #[inline(always)]
    fn others(self) -> [usize; 2] {
        let [next, after] = [(self.number + 1) % 3, (self.number + 2) % 3];
        if self.is_backwards { [after, next] } else { [next, after] }
    }
}

#[inline(always)]
fn max_abs(spoke: &[f64; 3]) -> f64 {
    spoke[0].abs().max(spoke[1].abs()).max(spoke[2].abs())
}

/// The least clearance of the turns from spoke to spoke, if all are left turns of less than half a turn and together
/// make one turn (closed) or less (open); else zero.
#[inline(always)]
fn clearance_of_turns(spokes: &[Spoke], closes: bool, turn: &impl Fn(Spoke, Spoke) -> f64) -> f64 {
    let max_parts = if closes { 4 } else { 2 };
    let mut start = 0;
    let mut num_parts = 1;
    let mut least = f64::INFINITY;
    for end in 1..spokes.len() {
        let clearance = turn(spokes[end - 1], spokes[end]);
        if clearance <= 0.0 {
            return 0.0;
        }
        least = least.min(clearance);
        if start + 1 < end {
            let since_start = turn(spokes[start], spokes[end]);
            // Rather another part than one with hardly any clearance.
            if since_start > 0.125 * clearance {
                least = least.min(since_start);
            } else {
                start = end - 1;
                num_parts += 1;
            }
        }
    }
    if num_parts <= max_parts { least } else { 0.0 }
}

/// Twice the signed area of the triangle between two spokes, positive for a left turn: a lower bound.
#[inline(always)]
fn left_turn_area(from: Spoke, to: Spoke) -> f64 {
    from.x * to.y - from.y * to.x - (ROUNDING * (from.max_abs * to.max_abs) + FLOOR)
}

/// How far the centre and both points may move before the turn from one to the other may be no left turn any more.
///
/// Twice the area is `c = a x b`. If everything moves by m or less, a and b change by 2 m, hence c by at most
/// `2 m (|a| + |b|) + 4 m^2`. With `m = c / 2.5 (|a| + |b|)` and `c <= |a| |b| <= (|a| + |b|)^2 / 4` the second term is
/// at most a fifth of the first, and both are 0.96 c.
#[inline(always)]
fn left_turn_clearance(from: Spoke, to: Spoke) -> f64 {
    let area = left_turn_area(from, to);
    if area > 0.0 { area / (2.5 * (from.x.abs() + from.y.abs() + to.x.abs() + to.y.abs())) } else { 0.0 }
}
