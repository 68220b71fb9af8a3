//! The separating-axis test for eight pairs of triangles in single precision.

use super::separating_axis::{ROUNDING, Separated, TrianglePair};
use crate::{
    intersect::bvh::{POINT_F32_ERROR, PointF32},
    simd::{F32_LANES, F32x8Lanes},
};

/// One bit for each of eight pairs of triangles for which a separating axis is found, or that is marked in `unused`.
///
/// `corners` are indices into `points`: for both triangles and each corner those of all pairs. Three axes are tried:
/// what they leave open is worth double precision.
///
/// The map into single precision takes each coordinate up to [`POINT_F32_ERROR`] away from where a similarity would,
/// and a difference of two projections of differences four times as far: that much is added to what rounding does.
#[inline(always)]
pub(crate) fn separated_mask_x8<L: F32x8Lanes>(
    simd: L,
    points: &[PointF32],
    corners: &[[[u32; F32_LANES]; 3]; 2],
    unused: u32,
) -> u32 {
    let mut triangles = [[[simd.splat(0.0); 3]; 3]; 2];
    for (triangle, corners) in triangles.iter_mut().zip(corners) {
        for (corner, indices) in triangle.iter_mut().zip(corners) {
            *corner = simd.gather(points, indices);
        }
    }
    let mut pair = TrianglePair::new(simd, &triangles[0], &triangles[1]);
    for max_abs in &mut pair.max_abs {
        *max_abs = simd.add(*max_abs, simd.splat(5.0 * POINT_F32_ERROR / (ROUNDING * L::ROUNDOFF)));
    }
    let mut separated = Separated { mask: unused, all: 0xff };
    pair.try_likely_axes(&mut separated);
    separated.mask
}
