//! The test of vertex stars ([`vertex_star`](super::vertex_star)) for eight stars in single precision, along axes only.

use super::one_rings::OneRingsX8;
use crate::{
    intersect::bvh::{POINT_F32_ERROR, PointF32},
    simd::F32x8Lanes,
};

/// One bit for each of eight vertex stars whose faces are proven not to intersect beyond its centre.
///
/// The projection along the axis nearest to the normal of the first face is injective if each spoke is reached from the
/// one before by a left turn of less than half a turn, and all of them make one turn. The number of turns is that of
/// the crossings of the first coordinate axis from below to above.
#[inline(always)]
pub(crate) fn injective_mask_x8<L: F32x8Lanes>(simd: L, points: &[PointF32], rings: &OneRingsX8<'_>) -> u32 {
    let Some([first, second]) = rings.around.first_chunk() else { return 0 };
    let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
    let centre = simd.gather(points, rings.centres);
    let first = simd.sub3(simd.gather(points, first), centre);
    let second = simd.sub3(simd.gather(points, second), centre);
    let axis = Axis::nearest_to(simd, simd.cross(first, second));
    let start = axis.project(simd, first);
    let mut spoke = start;
    let mut num_turns = zero;
    let mut min_area = simd.splat(f64::from(f32::MAX));
    let mut max_abs = zero;
    for step in 0..rings.around.len() {
        let next = match rings.around.get(step + 1) {
            Some(indices) => axis.project(simd, simd.sub3(simd.gather(points, indices), centre)),
            None => start,
        };
        min_area = simd.min(min_area, simd.sub(simd.mul(spoke[0], next[1]), simd.mul(spoke[1], next[0])));
        max_abs = simd.max(max_abs, simd.max(simd.abs(next[0]), simd.abs(next[1])));
        let (before, after) = (simd.sub(zero, spoke[1]), simd.sub(zero, next[1]));
        num_turns = simd.add(num_turns, simd.select(before, simd.select(after, zero, one), zero));
        spoke = next;
    }
    let is_one_turn = simd.min(simd.sub(simd.splat(1.5), num_turns), num_turns);
    simd.gt_zero_mask(simd.min(simd.sub(min_area, area_error(simd, max_abs)), is_one_turn))
}

/// Error bound of twice the area between two spokes.
///
/// A spoke is off by d = 2 m + u r for a map off by m, roundoff u and spokes as far as r; twice an area, by that and
/// the rounding of its own terms, at most 4 r d + 2 d^2 + 7 u r^2.
#[inline(always)]
fn area_error<L: F32x8Lanes>(simd: L, max_abs: L::Vector) -> L::Vector {
    let off = simd.add(simd.splat(2.0 * POINT_F32_ERROR), simd.mul(simd.splat(L::ROUNDOFF), max_abs));
    let off = simd.mul(off, simd.add(simd.mul(simd.splat(5.0), max_abs), simd.mul(simd.splat(3.0), off)));
    let rounding = simd.mul(simd.splat(8.0 * L::ROUNDOFF), simd.mul(max_abs, max_abs));
    simd.add(simd.add(off, rounding), simd.splat(L::FLOOR))
}

/// For each star the axis along which it is seen.
pub(super) struct Axis<V> {
    /// Above zero where it is the first axis, and where it is the second.
    is: [V; 2],
    /// Minus one where the star is seen from behind, else one.
    hand: V,
}

impl<V: Copy> Axis<V> {
    #[inline(always)]
    pub(super) fn nearest_to<L: F32x8Lanes<Vector = V>>(simd: L, direction: [V; 3]) -> Self {
        let [x, y, z] = [simd.abs(direction[0]), simd.abs(direction[1]), simd.abs(direction[2])];
        let is_x = simd.sub(x, simd.max(y, z));
        let is_y = simd.sub(y, simd.max(x, z));
        let along = simd.select(is_x, direction[0], simd.select(is_y, direction[1], direction[2]));
        Self { is: [is_x, is_y], hand: simd.select(along, simd.splat(1.0), simd.splat(-1.0)) }
    }

    /// The coordinates of a point at right angles to the axis.
    #[inline(always)]
    pub(super) fn project<L: F32x8Lanes<Vector = V>>(&self, simd: L, [x, y, z]: [V; 3]) -> [V; 2] {
        let [is_x, is_y] = self.is;
        let first = simd.select(is_x, y, simd.select(is_y, z, x));
        let second = simd.select(is_x, z, simd.select(is_y, x, y));
        [first, simd.mul(self.hand, second)]
    }
}
