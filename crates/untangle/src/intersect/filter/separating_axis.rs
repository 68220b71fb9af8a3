//! Separating-axis test of two triangles, with a forward error bound.
//!
//! If all corners of one triangle lie further along some axis than all corners of the other, the two have no point in
//! common (Gottschalk, Lin and Manocha 1996). That holds for any axis: a rounded normal is taken as exact, and only the
//! rounding of the projections onto it has to be bounded (in the manner of Shewchuk 1997). A test that finds an axis
//! separates the two for certain; one that finds none decides nothing.

use crate::simd::{Lanes, Scalar};

/// Corners in metres.
pub(crate) type Triangle<T = f64> = [[T; 3]; 3];

/// Relative error of a difference of two projections, in units of roundoff.
///
/// With unit roundoff e a projection `m . (p - o)` has one rounding in the difference, one in the product and two in
/// the sums: its error is at most 4 e (1 + 4 e) times `sum |m_i| |p_i - o_i|`. Two projections and the rounding of
/// their difference make 10 e of the largest such sum; the sum itself is computed with as many roundings, hence 16.
pub(super) const ROUNDING: f64 = 16.0;

/// Two triangles relative to the first corner of the first, or as many pairs as there are lanes.
pub(super) struct TrianglePair<L: Lanes> {
    pub(super) simd: L,
    a: [[L::Vector; 3]; 2],
    b: [[L::Vector; 3]; 3],
    /// Upper bounds of the magnitude of each coordinate: what rounding goes by.
    pub(super) max_abs: [L::Vector; 3],
}

/// What is done with an axis. A method and not a closure, since closures are not always inlined, and then compiled for
/// the baseline instruction set.
pub(super) trait AxisTest<L: Lanes> {
    /// Tests one axis; true if no further one needs testing.
    fn try_axis(&mut self, pair: &TrianglePair<L>, axis: [L::Vector; 3]) -> bool;
}

impl<L: Lanes> TrianglePair<L> {
    #[inline(always)]
    pub(super) fn new(simd: L, a: &Triangle<L::Vector>, b: &Triangle<L::Vector>) -> Self {
        let origin = a[0];
        let a = [simd.sub3(a[1], origin), simd.sub3(a[2], origin)];
        let b = [simd.sub3(b[0], origin), simd.sub3(b[1], origin), simd.sub3(b[2], origin)];
        let mut max_abs = [simd.splat(0.0); 3];
        for corner in [a[0], a[1], b[0], b[1], b[2]] {
            for axis in 0..3 {
                max_abs[axis] = simd.max(max_abs[axis], simd.abs(corner[axis]));
            }
        }
        Self { simd, a, b, max_abs }
    }

    /// Tries nine axes until the test is content: those of [`try_likely_axes`](Self::try_likely_axes), then for each
    /// edge the one at right angles to it in its triangle's plane, which separates neighbours in one sheet.
    #[inline(always)]
    pub(super) fn try_all_axes(&self, test: &mut impl AxisTest<L>) -> bool {
        let Self { simd, a, .. } = *self;
        if self.try_likely_axes(test) {
            return true;
        }
        let (edges_a, edges_b) = ([a[0], simd.sub3(a[1], a[0]), a[1]], self.edges_of_b());
        let normals = [simd.cross(a[0], a[1]), simd.cross(edges_b[0], edges_b[1])];
        for (edges, normal) in [(edges_a, normals[0]), (edges_b, normals[1])] {
            for edge in edges {
                if test.try_axis(self, simd.cross(edge, normal)) {
                    return true;
                }
            }
        }
        false
    }

    /// Tries three axes until the test is content: from centroid to centroid, and both normals.
    #[inline(always)]
    pub(super) fn try_likely_axes(&self, test: &mut impl AxisTest<L>) -> bool {
        let Self { simd, a, .. } = *self;
        if test.try_axis(self, self.centroid_offset()) || test.try_axis(self, simd.cross(a[0], a[1])) {
            return true;
        }
        let [first, second, _] = self.edges_of_b();
        test.try_axis(self, simd.cross(first, second))
    }

    /// From the centroid of one triangle to that of the other, times three.
    #[inline(always)]
    fn centroid_offset(&self) -> [L::Vector; 3] {
        let Self { simd, a: [p, q], b: [r, s, t], .. } = *self;
        let mut offset = [simd.splat(0.0); 3];
        for axis in 0..3 {
            let sum = simd.add(simd.add(r[axis], s[axis]), t[axis]);
            offset[axis] = simd.sub(simd.sub(sum, p[axis]), q[axis]);
        }
        offset
    }

    #[inline(always)]
    fn edges_of_b(&self) -> [[L::Vector; 3]; 3] {
        let Self { simd, b, .. } = *self;
        [simd.sub3(b[1], b[0]), simd.sub3(b[2], b[1]), simd.sub3(b[0], b[2])]
    }

    /// The gap between the projections onto an axis, times the axis' length: a lower bound, not positive where they may
    /// overlap.
    #[inline(always)]
    pub(super) fn gap_along(&self, axis: [L::Vector; 3]) -> L::Vector {
        let Self { simd, a, b, max_abs } = *self;
        let zero = simd.splat(0.0);
        let [p, q] = [simd.dot(axis, a[0]), simd.dot(axis, a[1])];
        let [r, s, t] = [simd.dot(axis, b[0]), simd.dot(axis, b[1]), simd.dot(axis, b[2])];
        let (min_a, max_a) = (simd.min(simd.min(p, q), zero), simd.max(simd.max(p, q), zero));
        let (min_b, max_b) = (simd.min(simd.min(r, s), t), simd.max(simd.max(r, s), t));
        let gap = simd.max(simd.sub(min_b, max_a), simd.sub(min_a, max_b));
        let magnitudes = [simd.abs(axis[0]), simd.abs(axis[1]), simd.abs(axis[2])];
        let rounding = simd.mul(simd.splat(ROUNDING * L::ROUNDOFF), simd.dot(magnitudes, max_abs));
        simd.sub(gap, simd.add(rounding, simd.splat(L::FLOOR)))
    }
}

/// Whether a separating axis of two triangles is found; nine are tried at worst.
#[inline(always)]
pub(crate) fn are_separated(a: &Triangle, b: &Triangle) -> bool {
    TrianglePair::new(Scalar, a, b).try_all_axes(&mut Separated { mask: 0, all: 1 })
}

/// Collects the lanes for which some axis separates the triangles, until those are `all`.
pub(super) struct Separated {
    pub(super) mask: u32,
    pub(super) all: u32,
}

impl<L: Lanes> AxisTest<L> for Separated {
    #[inline(always)]
    fn try_axis(&mut self, pair: &TrianglePair<L>, axis: [L::Vector; 3]) -> bool {
        self.mask |= pair.simd.gt_zero_mask(pair.gap_along(axis));
        self.mask == self.all
    }
}
