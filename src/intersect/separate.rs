//! Proofs in plain double arithmetic that two triangles are apart.
//!
//! If all corners of one triangle lie further along some vector than all corners of the other, they do not meet, whatever the vector is: it may
//! be the rounded normal of one of them and is taken as exact. What is left to bound is the rounding of the projections. A proof that
//! succeeds spares the exact signs; one that fails says nothing.

/// Corners in metres.
pub(crate) type Triangle = [[f64; 3]; 3];

/// Relative error of a difference of two projections.
///
/// With unit roundoff e = 2^-53 a projection `m . (p - o)` has one rounding in the difference, one in the product and two in the sums: its error
/// is at most 4 e (1 + 4 e) times `sum |m_i| |p_i - o_i|`. Two projections and the rounding of their difference make 10 e of the largest such sum; the
/// sum itself is computed with as many roundings, hence 16.
const ROUNDING: f64 = 16.0 * (f64::EPSILON / 2.0);

/// Differences below it may come from underflow, where errors are not relative.
const FLOOR: f64 = 1e-290;

/// Two triangles relative to the first corner of the first.
struct Relative {
    a: [[f64; 3]; 2],
    b: [[f64; 3]; 3],
    /// The largest magnitude of each coordinate.
    reach: [f64; 3],
}

impl Relative {
    #[inline(always)]
    fn new(a: &Triangle, b: &Triangle) -> Self {
        let origin = a[0];
        let a = [minus(a[1], origin), minus(a[2], origin)];
        let b = b.map(|corner| minus(corner, origin));
        let reach = std::array::from_fn(|axis| {
            let [p, q] = a.map(|corner| corner[axis].abs());
            let [r, s, t] = b.map(|corner| corner[axis].abs());
            higher(higher(higher(p, q), higher(r, s)), t)
        });
        Self { a, b, reach }
    }

    /// From the middle of one triangle to that of the other, times three.
    #[inline(always)]
    fn across(&self) -> [f64; 3] {
        let ([p, q], [r, s, t]) = (self.a, self.b);
        std::array::from_fn(|axis| r[axis] + s[axis] + t[axis] - p[axis] - q[axis])
    }

    /// Whether one of the directions that may part the triangles will do.
    #[inline(always)]
    fn any_direction(&self, mut will_do: impl FnMut([f64; 3]) -> bool) -> bool {
        if will_do(self.across()) {
            return true;
        }
        let edges_a = [self.a[0], minus(self.a[1], self.a[0]), self.a[1]];
        let normal_a = cross(self.a[0], self.a[1]);
        if will_do(normal_a) {
            return true;
        }
        let edges_b = [minus(self.b[1], self.b[0]), minus(self.b[2], self.b[1]), minus(self.b[0], self.b[2])];
        let normal_b = cross(edges_b[0], edges_b[1]);
        will_do(normal_b)
            || edges_a.iter().any(|&edge| will_do(cross(edge, normal_a)))
            || edges_b.iter().any(|&edge| will_do(cross(edge, normal_b)))
    }

    /// How much further one triangle lies along `m` than the other, times the length of `m`: less than the truth, or not positive.
    #[inline(always)]
    fn gap_along(&self, m: [f64; 3]) -> f64 {
        let [p, q] = self.a.map(|corner| dot(m, corner));
        let [r, s, t] = self.b.map(|corner| dot(m, corner));
        let (low_a, high_a) = (lower(lower(p, q), 0.0), higher(higher(p, q), 0.0));
        let (low_b, high_b) = (lower(lower(r, s), t), higher(higher(r, s), t));
        let gap = higher(low_b - high_a, low_a - high_b);
        gap - (ROUNDING * dot(m.map(f64::abs), self.reach) + FLOOR)
    }
}

/// Whether two triangles are proven to have no point in common. At worst nine vectors are tried: from middle to middle, both normals, and the
/// directions at right angles to an edge within its triangle's plane, which part neighbours in one sheet.
#[inline(always)]
pub(crate) fn are_apart(a: &Triangle, b: &Triangle) -> bool {
    let relative = Relative::new(a, b);
    relative.any_direction(|m| relative.gap_along(m) > 0.0)
}

/// A lower bound of the distance of two triangles in metres; zero where none is known. What is beyond `enough` does not matter.
#[inline(always)]
pub(crate) fn distance_m(a: &Triangle, b: &Triangle, enough: f64) -> f64 {
    let relative = Relative::new(a, b);
    let mut distance = 0.0;
    relative.any_direction(|m| {
        let gap = relative.gap_along(m);
        if gap > 0.0 {
            let square = dot(m, m);
            // Of a square that underflows nothing is known.
            if square > 1e-280 {
                distance = higher(distance, gap / square.sqrt() * (1.0 - 1e-14));
            }
        }
        distance >= enough
    });
    distance
}

#[inline(always)]
pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// One instruction, where `f64::min` takes several for the sake of NaN, which frames never hold.
#[inline(always)]
pub(crate) fn lower(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn higher(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
