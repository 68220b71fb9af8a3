//! The proofs of [`umbrella`](super::umbrella) for eight rings at a time, in single precision and along axes only: what they leave open is few.

use super::{
    rings::EightRings,
    singles::{Eights, MAPPED_ERROR, Mapped},
};

/// One bit for each of eight rings whose faces are proven not to meet beyond its centre.
///
/// Seen along the axis nearest to the normal of its first face, a ring is an umbrella if each spoke is reached from the one before by a left turn
/// of less than half a turn, and all of them are one turn. How often such turns go round is how often they come up over the first
/// direction: from below it to it, or above.
#[inline(always)]
pub(crate) fn are_open<A: Eights>(by: A, points: &[Mapped], rings: &EightRings<'_>) -> u32 {
    let Some([first, second]) = rings.around.first_chunk() else { return 0 };
    let (zero, one) = (by.of(0.0), by.of(1.0));
    let centre = by.gather(points, rings.centres);
    let (first, second) = (by.minus(by.gather(points, first), centre), by.minus(by.gather(points, second), centre));
    let axis = Axis::of(by, by.cross(first, second));
    let start = axis.along(by, first);
    let mut spoke = start;
    let mut turns = zero;
    let mut least = by.of(f64::from(f32::MAX));
    let mut reach = zero;
    for step in 0..rings.around.len() {
        let next = match rings.around.get(step + 1) {
            Some(at) => axis.along(by, by.minus(by.gather(points, at), centre)),
            None => start,
        };
        least = by.lower(least, by.difference(by.product(spoke[0], next[1]), by.product(spoke[1], next[0])));
        reach = by.higher(reach, by.higher(by.magnitude(next[0]), by.magnitude(next[1])));
        let (before, after) = (by.difference(zero, spoke[1]), by.difference(zero, next[1]));
        turns = by.sum(turns, by.choose(before, by.choose(after, zero, one), zero));
        spoke = next;
    }
    // A spoke is off by d = 2 m + u r for maps off by m, roundoff u and spokes as far as r; twice an area, by that and the rounding of its own
    // terms, at most 4 r d + 2 d^2 + 7 u r^2.
    let off = by.sum(by.of(2.0 * MAPPED_ERROR), by.product(by.of(A::ROUNDOFF), reach));
    let off = by.product(off, by.sum(by.product(by.of(5.0), reach), by.product(by.of(3.0), off)));
    let rounding = by.product(by.of(8.0 * A::ROUNDOFF), by.product(reach, reach));
    let bound = by.sum(by.sum(off, rounding), by.of(A::FLOOR));
    let went_once = by.difference(by.of(1.5), turns);
    by.positive(by.lower(by.difference(least, bound), by.lower(went_once, turns)))
}

/// For each ring the two axes at right angles to one, and whether they have to change hands.
struct Axis<V> {
    /// Above zero where it is the first axis, and where it is the second.
    is: [V; 2],
    /// One, or minus one where the ring is seen from behind.
    hand: V,
}

impl<V: Copy> Axis<V> {
    /// The axis nearest to a direction.
    #[inline(always)]
    fn of<A: Eights<Value = V>>(by: A, direction: [V; 3]) -> Self {
        let [x, y, z] = [by.magnitude(direction[0]), by.magnitude(direction[1]), by.magnitude(direction[2])];
        let is_x = by.difference(x, by.higher(y, z));
        let is_y = by.difference(y, by.higher(x, z));
        let along = by.choose(is_x, direction[0], by.choose(is_y, direction[1], direction[2]));
        Self { is: [is_x, is_y], hand: by.choose(along, by.of(1.0), by.of(-1.0)) }
    }

    /// A point as seen along the axis.
    #[inline(always)]
    fn along<A: Eights<Value = V>>(&self, by: A, [x, y, z]: [V; 3]) -> [V; 2] {
        let [is_x, is_y] = self.is;
        let first = by.choose(is_x, y, by.choose(is_y, z, x));
        let second = by.choose(is_x, z, by.choose(is_y, x, y));
        [first, by.product(self.hand, second)]
    }
}
