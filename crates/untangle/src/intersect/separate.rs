//! Proofs in plain floating-point arithmetic that two triangles are apart.
//!
//! If all corners of one triangle lie further along some vector than all corners of the other, they do not meet, whatever the vector is: it may
//! be the rounded normal of one of them and is taken as exact. What is left to bound is the rounding of the projections. A proof that
//! succeeds spares the exact signs; one that fails says nothing.

use super::{
    arithmetic::{Arithmetic, Plain, Roots},
    boxes::WIDTH,
    lanes::FOUR,
    singles::{Eights, MAPPED_ERROR, Mapped},
};

/// Corners in metres.
pub(crate) type Triangle<T = f64> = [[T; 3]; 3];

/// Four triangles, coordinate by coordinate.
pub(crate) type FourTriangles = Triangle<[f64; FOUR]>;

/// All of four pairs.
pub(crate) const ALL_FOUR: u32 = (1 << FOUR) - 1;

/// Relative error of a difference of two projections, in units of roundoff.
///
/// With unit roundoff e a projection `m . (p - o)` has one rounding in the difference, one in the product and two in the sums: its error
/// is at most 4 e (1 + 4 e) times `sum |m_i| |p_i - o_i|`. Two projections and the rounding of their difference make 10 e of the largest such sum; the
/// sum itself is computed with as many roundings, hence 16.
const ROUNDING: f64 = 16.0;

/// Two triangles, or several pairs side by side, relative to the first corner of the first.
struct Relative<A: Arithmetic> {
    by: A,
    a: [[A::Value; 3]; 2],
    b: [[A::Value; 3]; 3],
    /// The largest magnitude of each coordinate, or more.
    reach: [A::Value; 3],
}

impl<A: Arithmetic> Relative<A> {
    #[inline(always)]
    fn new(by: A, a: &Triangle<A::Value>, b: &Triangle<A::Value>) -> Self {
        let origin = a[0];
        let a = [by.minus(a[1], origin), by.minus(a[2], origin)];
        let b = [by.minus(b[0], origin), by.minus(b[1], origin), by.minus(b[2], origin)];
        let mut reach = [by.of(0.0); 3];
        for corner in [a[0], a[1], b[0], b[1], b[2]] {
            for axis in 0..3 {
                reach[axis] = by.higher(reach[axis], by.magnitude(corner[axis]));
            }
        }
        Self { by, a, b, reach }
    }

    /// From the middle of one triangle to that of the other, times three.
    #[inline(always)]
    fn across(&self) -> [A::Value; 3] {
        let Self { by, a: [p, q], b: [r, s, t], .. } = *self;
        let mut across = [by.of(0.0); 3];
        for axis in 0..3 {
            let sum = by.sum(by.sum(r[axis], s[axis]), t[axis]);
            across[axis] = by.difference(by.difference(sum, p[axis]), q[axis]);
        }
        across
    }

    /// Tries directions that may part the triangles until one will do: first those of [`likely_direction`](Self::likely_direction), then those
    /// at right angles to an edge within its triangle's plane, which part neighbours in one sheet.
    #[inline(always)]
    fn any_direction(&self, test: &mut impl Test<A>) -> bool {
        let Self { by, a, .. } = *self;
        if self.likely_direction(test) {
            return true;
        }
        let (edges_a, edges_b) = ([a[0], by.minus(a[1], a[0]), a[1]], self.edges_of_b());
        let normals = [by.cross(a[0], a[1]), by.cross(edges_b[0], edges_b[1])];
        for (edges, normal) in [(edges_a, normals[0]), (edges_b, normals[1])] {
            for edge in edges {
                if test.will_do(self, by.cross(edge, normal)) {
                    return true;
                }
            }
        }
        false
    }

    /// The same with a few directions: from middle to middle, and both normals.
    #[inline(always)]
    fn likely_direction(&self, test: &mut impl Test<A>) -> bool {
        let Self { by, a, .. } = *self;
        if test.will_do(self, self.across()) || test.will_do(self, by.cross(a[0], a[1])) {
            return true;
        }
        let [one, other, _] = self.edges_of_b();
        test.will_do(self, by.cross(one, other))
    }

    #[inline(always)]
    fn edges_of_b(&self) -> [[A::Value; 3]; 3] {
        let Self { by, b, .. } = *self;
        [by.minus(b[1], b[0]), by.minus(b[2], b[1]), by.minus(b[0], b[2])]
    }

    /// How much further one triangle lies along `m` than the other, times the length of `m`: less than the truth, or not positive.
    #[inline(always)]
    fn gap_along(&self, m: [A::Value; 3]) -> A::Value {
        let Self { by, a, b, reach } = *self;
        let zero = by.of(0.0);
        let [p, q] = [by.dot(m, a[0]), by.dot(m, a[1])];
        let [r, s, t] = [by.dot(m, b[0]), by.dot(m, b[1]), by.dot(m, b[2])];
        let (low_a, high_a) = (by.lower(by.lower(p, q), zero), by.higher(by.higher(p, q), zero));
        let (low_b, high_b) = (by.lower(by.lower(r, s), t), by.higher(by.higher(r, s), t));
        let gap = by.higher(by.difference(low_b, high_a), by.difference(low_a, high_b));
        let magnitudes = [by.magnitude(m[0]), by.magnitude(m[1]), by.magnitude(m[2])];
        let rounding = by.product(by.of(ROUNDING * A::ROUNDOFF), by.dot(magnitudes, reach));
        by.difference(gap, by.sum(rounding, by.of(A::FLOOR)))
    }
}

/// What a direction is good for. A method and no closure: those are not always inlined, and then compiled for the least of instruction sets.
trait Test<A: Arithmetic> {
    fn will_do(&mut self, relative: &Relative<A>, m: [A::Value; 3]) -> bool;
}

/// Whether two triangles are proven to have no point in common. At worst nine vectors are tried.
#[inline(always)]
pub(crate) fn are_apart(a: &Triangle, b: &Triangle) -> bool {
    Relative::new(Plain, a, b).any_direction(&mut Parts)
}

struct Parts;

impl Test<Plain> for Parts {
    #[inline(always)]
    fn will_do(&mut self, relative: &Relative<Plain>, m: [f64; 3]) -> bool {
        relative.gap_along(m) > 0.0
    }
}

/// A lower bound of the distance of two triangles, or of several pairs side by side, in metres; zero where none is known. What is beyond
/// `enough` does not matter, nor what lies in the lanes of `unused`.
#[inline(always)]
pub(crate) fn distances_m<A: Roots>(by: A, pairs: [&Triangle<A::Value>; 2], enough: f64, unused: u32) -> A::Value {
    let mut farthest = Farthest { distance: by.of(0.0), enough: by.of(enough), unused };
    Relative::new(by, pairs[0], pairs[1]).any_direction(&mut farthest);
    farthest.distance
}

struct Farthest<T> {
    distance: T,
    enough: T,
    unused: u32,
}

impl<A: Roots> Test<A> for Farthest<A::Value> {
    #[inline(always)]
    fn will_do(&mut self, relative: &Relative<A>, m: [A::Value; 3]) -> bool {
        let by = relative.by;
        let (gap, square) = (relative.gap_along(m), by.dot(m, m));
        let distance = by.product(by.quotient(gap, by.root(square)), by.of(1.0 - 1e-14));
        // Of a square that underflows nothing is known.
        let zero = by.of(0.0);
        let distance = by.choose(gap, by.choose(by.difference(square, by.of(1e-280)), distance, zero), zero);
        self.distance = by.higher(self.distance, distance);
        by.positive(by.difference(self.enough, self.distance)) & !self.unused == 0
    }
}

/// One bit for each of four pairs of triangles that is proven to be apart, or that is marked in `unused`.
#[inline(always)]
pub(crate) fn are_four_apart<A: Arithmetic>(by: A, pairs: [&Triangle<A::Value>; 2], unused: u32) -> u32 {
    let mut parted = PartsAll { apart: unused, all: ALL_FOUR };
    Relative::new(by, pairs[0], pairs[1]).any_direction(&mut parted);
    parted.apart
}

/// The same for eight pairs of mapped triangles, corner by corner. Few directions are tried: what is left is worth double arithmetic.
///
/// The map takes each coordinate up to [`MAPPED_ERROR`] away from where a similarity would, and a difference of two projections of differences
/// four times as far: that much is added to what rounding does.
#[inline(always)]
pub(crate) fn are_eight_apart<A: Eights>(
    by: A,
    points: &[Mapped],
    corners: &[[[u32; WIDTH]; 3]; 2],
    unused: u32,
) -> u32 {
    let mut triangles = [[[by.of(0.0); 3]; 3]; 2];
    for (triangle, corners) in triangles.iter_mut().zip(corners) {
        for (corner, at) in triangle.iter_mut().zip(corners) {
            *corner = by.gather(points, at);
        }
    }
    let mut pair = Relative::new(by, &triangles[0], &triangles[1]);
    for reach in &mut pair.reach {
        *reach = by.sum(*reach, by.of(5.0 * MAPPED_ERROR / (ROUNDING * A::ROUNDOFF)));
    }
    let mut parted = PartsAll { apart: unused, all: 0xff };
    pair.likely_direction(&mut parted);
    parted.apart
}

struct PartsAll {
    apart: u32,
    all: u32,
}

impl<A: Arithmetic> Test<A> for PartsAll {
    #[inline(always)]
    fn will_do(&mut self, relative: &Relative<A>, m: [A::Value; 3]) -> bool {
        self.apart |= relative.by.positive(relative.gap_along(m));
        self.apart == self.all
    }
}

/// Puts a pair of triangles beside others.
#[inline(always)]
pub(crate) fn put(pairs: &mut [FourTriangles; 2], lane: usize, pair: [Triangle; 2]) {
    for (four, triangle) in pairs.iter_mut().zip(pair) {
        for (four, corner) in four.iter_mut().zip(triangle) {
            for (lanes, coordinate) in four.iter_mut().zip(corner) {
                lanes[lane] = coordinate;
            }
        }
    }
}

#[inline(always)]
pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    Plain.minus(a, b)
}

#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    Plain.dot(a, b)
}

#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    Plain.cross(a, b)
}
