//! Pairs of triangles, and of their primitives, that are farther apart than a margin: in single precision, for eight.
//!
//! All is about points as they are after the map into single precision: a margin of
//! [`margin_f32`](crate::intersect::Bvh::margin_f32) is larger than a distance by more than what the map changes.

use super::separating_axis::{AxisTest, ROUNDING, TrianglePair};
use crate::{
    intersect::bvh::{PointF32, min},
    simd::{F32_LANES, F32x8Lanes, Lanes},
};

/// No filter proves more than this: all points but far ones, which none is asked about, are nearer to each other. So
/// nothing overflows.
pub(super) const MAX_MARGIN: f32 = 8.0;

/// One bit for each of eight pairs of triangles that are proven to be farther apart than `margin`.
///
/// `corners` are indices into `points`: for both triangles and each corner those of all pairs.
#[inline(always)]
pub(crate) fn apart_mask_x8<L: F32x8Lanes>(
    simd: L,
    points: &[PointF32],
    corners: &[[[u32; F32_LANES]; 3]; 2],
    margin: f32,
) -> u32 {
    let mut triangles = [[[simd.splat(0.0); 3]; 3]; 2];
    for (triangle, corners) in triangles.iter_mut().zip(corners) {
        for (corner, indices) in triangle.iter_mut().zip(corners) {
            *corner = simd.gather(points, indices);
        }
    }
    let mut apart = Apart { margin_squared: margin_squared(simd, margin), mask: 0 };
    TrianglePair::new(simd, &triangles[0], &triangles[1]).try_likely_axes(&mut apart);
    apart.mask
}

/// One bit for each of eight pairs of a vertex and a face that are proven to be farther apart than `margin`: by the
/// direction between their middles, or the normal of the face. The first index is the vertex.
#[inline(always)]
pub(crate) fn apart_vertex_face_mask_x8<L: F32x8Lanes>(
    simd: L,
    points: &[PointF32],
    vertices: &[[u32; F32_LANES]; 4],
    margin: f32,
) -> u32 {
    let [vertex, a, b, c] = gather4(simd, points, vertices);
    let differences = [simd.sub3(a, vertex), simd.sub3(b, vertex), simd.sub3(c, vertex)];
    let middles = add3(simd, add3(simd, differences[0], differences[1]), differences[2]);
    let normal = simd.cross(simd.sub3(b, a), simd.sub3(c, a));
    apart_along(simd, &differences, [middles, normal], margin)
}

/// The same of eight pairs of edges: by the direction between their middles, or the one at right angles to both. The
/// first two indices are the ends of the first edge.
#[inline(always)]
pub(crate) fn apart_edges_mask_x8<L: F32x8Lanes>(
    simd: L,
    points: &[PointF32],
    ends: &[[u32; F32_LANES]; 4],
    margin: f32,
) -> u32 {
    let [a, b, c, d] = gather4(simd, points, ends);
    let differences = [simd.sub3(c, a), simd.sub3(d, a), simd.sub3(c, b), simd.sub3(d, b)];
    let middles = add3(simd, differences[0], differences[3]);
    let normal = simd.cross(simd.sub3(b, a), simd.sub3(d, c));
    apart_along(simd, &differences, [middles, normal], margin)
}

/// The lanes in which one of two axes proves that all differences of two primitives reach beyond a margin.
#[inline(always)]
fn apart_along<L: F32x8Lanes, const N: usize>(
    simd: L,
    differences: &[[L::Vector; 3]; N],
    axes: [[L::Vector; 3]; 2],
    margin: f32,
) -> u32 {
    let mut max_abs = [simd.splat(0.0); 3];
    for difference in differences {
        for axis in 0..3 {
            max_abs[axis] = simd.max(max_abs[axis], simd.abs(difference[axis]));
        }
    }
    let margin_squared = margin_squared(simd, margin);
    let mut mask = 0;
    for axis in axes {
        let along = simd.dot(axis, differences[0]);
        let (mut least, mut greatest) = (along, along);
        for difference in &differences[1..] {
            let along = simd.dot(axis, *difference);
            (least, greatest) = (simd.min(least, along), simd.max(greatest, along));
        }
        let magnitudes = [simd.abs(axis[0]), simd.abs(axis[1]), simd.abs(axis[2])];
        let rounding = simd.mul(simd.splat(ROUNDING * L::ROUNDOFF), simd.dot(magnitudes, max_abs));
        let reach = simd.max(least, simd.sub(simd.splat(0.0), greatest));
        let gap = simd.sub(reach, simd.add(rounding, simd.splat(L::FLOOR)));
        mask |= beyond_mask(simd, gap, axis, margin_squared);
    }
    mask
}

/// Collects the lanes for which some axis proves the triangles to be farther apart than a margin.
struct Apart<V> {
    margin_squared: V,
    mask: u32,
}

impl<L: Lanes> AxisTest<L> for Apart<L::Vector> {
    #[inline(always)]
    fn try_axis(&mut self, pair: &TrianglePair<L>, axis: [L::Vector; 3]) -> bool {
        self.mask |= beyond_mask(pair.simd, pair.gap_along(axis), axis, self.margin_squared);
        self.mask == 0xff
    }
}

/// The lanes in which a gap along an axis, times the axis' length, is beyond a margin. What underflows is less than the
/// floor.
#[inline(always)]
fn beyond_mask<L: Lanes>(simd: L, gap: L::Vector, axis: [L::Vector; 3], margin_squared: L::Vector) -> u32 {
    let needed = simd.add(simd.mul(margin_squared, simd.dot(axis, axis)), simd.splat(L::FLOOR));
    simd.gt_zero_mask(simd.min(gap, simd.sub(simd.mul(gap, gap), needed)))
}

#[inline(always)]
fn margin_squared<L: F32x8Lanes>(simd: L, margin: f32) -> L::Vector {
    let margin = simd.splat_f32(min(margin, MAX_MARGIN));
    simd.mul(margin, margin)
}

#[inline(always)]
fn gather4<L: F32x8Lanes>(simd: L, points: &[PointF32], rows: &[[u32; F32_LANES]; 4]) -> [[L::Vector; 3]; 4] {
    let [a, b, c, d] = rows;
    [simd.gather(points, a), simd.gather(points, b), simd.gather(points, c), simd.gather(points, d)]
}

#[inline(always)]
fn add3<L: Lanes>(simd: L, a: [L::Vector; 3], b: [L::Vector; 3]) -> [L::Vector; 3] {
    [simd.add(a[0], b[0]), simd.add(a[1], b[1]), simd.add(a[2], b[2])]
}
