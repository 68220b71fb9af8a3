//! Proofs that the faces round a vertex do not meet beyond it: seen from some direction they lie side by side, like an umbrella's.
//!
//! If every face, seen along some direction, turns the same way round the vertex, and all together turn once, then the faces lie in
//! sectors that do not overlap, so that they share the vertex and their common edges alone. Turning once is proven by few parts of less than half a turn
//! each: a closed ring turns a whole number of times, so that less than two turns are one; an open one has to stay below one.
//!
//! All of it holds strictly, hence also on the perturbed input.

use super::{
    rings::Ring,
    separate::{cross, dot, minus},
};
use crate::frame::Frame;

/// Relative error of `x_i y_j - x_j y_i` of projected points.
///
/// With unit roundoff e, `x = m . (p - o)` is off by at most 4 e (1 + 4 e) times `|m|_1 |p - o|_max`, a product of two such by 9 e, and their
/// difference by 10 e of twice the product of the largest magnitudes.
const ROUNDING: f64 = 32.0 * (f64::EPSILON / 2.0);

/// Differences below it may come from underflow, where errors are not relative.
const FLOOR: f64 = 1e-200;

/// Works out umbrellas, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct Umbrella {
    spokes: Vec<[f64; 3]>,
    flat: Vec<Spoke>,
}

/// A neighbour as seen from some direction, relative to the vertex.
#[derive(Clone, Copy, Debug)]
struct Spoke {
    x: f64,
    y: f64,
    /// Bound of the magnitudes of both coordinates before projection.
    reach: f64,
}

impl Umbrella {
    /// How far each vertex of a ring may move, in metres, with its faces still not meeting beyond its centre: a lower bound, positive where they are
    /// proven not to meet now.
    #[inline(always)]
    pub(crate) fn room_m(&mut self, frame: &Frame, ring: Ring<'_>) -> f64 {
        self.room(frame, ring, room_to_left)
    }

    /// Whether the faces of a ring are proven not to meet beyond its centre.
    #[inline(always)]
    pub(crate) fn is_open(&mut self, frame: &Frame, ring: Ring<'_>) -> bool {
        self.room(frame, ring, area_to_left) > 0.0
    }

    /// The same by any measure of a left turn that is positive for a proven one.
    #[inline(always)]
    fn room(&mut self, frame: &Frame, ring: Ring<'_>, turn: impl Fn(Spoke, Spoke) -> f64) -> f64 {
        let &[first, .., last] = ring.around else { return 0.0 };
        let closes = first == last;
        let centre: [f64; 3] = frame.position(ring.centre).into();
        self.spokes.clear();
        self.spokes.extend(ring.around.iter().map(|&vertex| minus(frame.position(vertex).into(), centre)));
        // Along an axis first: most cloth is smooth enough, and nothing needs projecting. Nearly always any of the faces says along which.
        let one = cross(self.spokes[0], self.spokes[1]);
        let room = self.room_along(Axis::of(one), closes, &turn);
        if room > 0.0 {
            return room;
        }
        let normal = self.spokes.windows(2).fold([0.0; 3], |sum, side| {
            let normal = cross(side[0], side[1]);
            [sum[0] + normal[0], sum[1] + normal[1], sum[2] + normal[2]]
        });
        let axis = Axis::of(normal);
        let room = if axis == Axis::of(one) { 0.0 } else { self.room_along(axis, closes, &turn) };
        if room > 0.0 {
            return room;
        }
        let size = normal[axis.number].abs();
        if size == 0.0 {
            return 0.0;
        }
        let [next, _] = axis.others();
        let normal = normal.map(|coordinate| coordinate / size);
        let mut aside = [0.0; 3];
        aside[next] = 1.0;
        let along = cross(aside, normal);
        let across = cross(normal, along);
        // Each at most 6 in the sum of its magnitudes.
        self.flat.clear();
        self.flat.extend(self.spokes.iter().map(|spoke| Spoke {
            x: dot(along, *spoke),
            y: dot(across, *spoke),
            reach: 6.0 * reach(spoke),
        }));
        // The two vectors are at most sqrt(2) and sqrt(6) long, so that a point moves, seen along them, less than three times as far.
        room_to_turn(&self.flat, closes, &turn) / 3.0
    }

    /// The same as seen along an axis.
    #[inline(always)]
    fn room_along(&mut self, axis: Axis, closes: bool, turn: &impl Fn(Spoke, Spoke) -> f64) -> f64 {
        let [next, after] = axis.others();
        self.flat.clear();
        self.flat.extend(self.spokes.iter().map(|spoke| Spoke {
            x: spoke[next],
            y: spoke[after],
            reach: reach(spoke),
        }));
        room_to_turn(&self.flat, closes, turn)
    }
}

/// An axis and a direction along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Axis {
    number: usize,
    is_backwards: bool,
}

impl Axis {
    /// The one nearest to a direction.
    #[inline(always)]
    fn of(normal: [f64; 3]) -> Self {
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
fn reach(spoke: &[f64; 3]) -> f64 {
    spoke[0].abs().max(spoke[1].abs()).max(spoke[2].abs())
}

/// Whether each spoke is reached from the one before by a left turn of less than half a turn, and the last one from the first by one
/// turn, or less than one: positive if so, and how far the points may move before it ends, at least.
#[inline(always)]
fn room_to_turn(spokes: &[Spoke], closes: bool, turn: &impl Fn(Spoke, Spoke) -> f64) -> f64 {
    let most_parts = if closes { 4 } else { 2 };
    let mut start = 0;
    let mut num_parts = 1;
    let mut least = f64::INFINITY;
    for end in 1..spokes.len() {
        let room = turn(spokes[end - 1], spokes[end]);
        if room <= 0.0 {
            return 0.0;
        }
        least = least.min(room);
        if start + 1 < end {
            let since_start = turn(spokes[start], spokes[end]);
            // What has hardly any room left is better a part of its own.
            if since_start > 0.125 * room {
                least = least.min(since_start);
            } else {
                start = end - 1;
                num_parts += 1;
            }
        }
    }
    if num_parts <= most_parts { least } else { 0.0 }
}

/// Twice the area to the left of the turn from one spoke to another: less than the truth.
#[inline(always)]
fn area_to_left(from: Spoke, to: Spoke) -> f64 {
    from.x * to.y - from.y * to.x - (ROUNDING * (from.reach * to.reach) + FLOOR)
}

/// How far the centre and both points may move before the turn from one to the other is no left turn any more.
///
/// Twice the area is `c = a x b`. If everything moves by m or less, a and b change by 2 m, hence c by at most 2 m (|a| + |b|) + 4 m^2. With
/// m = c / 2.5 (|a| + |b|) and c <= |a| |b| <= (|a| + |b|)^2 / 4 the second term is at most a fifth of the first, and both are 0.96 c.
#[inline(always)]
fn room_to_left(from: Spoke, to: Spoke) -> f64 {
    let area = area_to_left(from, to);
    if area > 0.0 { area / (2.5 * (from.x.abs() + from.y.abs() + to.x.abs() + to.y.abs())) } else { 0.0 }
}
