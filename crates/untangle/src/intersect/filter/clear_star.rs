//! Vertex stars whose primitives are farther apart than a margin, so far as they have no vertex in common: in single
//! precision for eight, and in double precision for one.
//!
//! Seen along some direction the faces round a vertex make one turn, as in the [injectivity
//! test](super::vertex_star_x8), in wedges between *spokes* to the neighbours; *links* join these. Of two primitives of
//! two faces without a common vertex one is on a link, and at least one whole wedge lies between them. With `H` the
//! least distance of a link from the centre, and `S` the least sine of a wedge, they are at least `H S` apart: a point
//! at a distance `h` from the centre is `h sin(angle)` from a ray, or `h` beyond a right angle. What is seen along a
//! direction is never farther apart than in space.
//!
//! As in [`apart_x8`](super::apart_x8), points are those after the map.

use nalgebra::Vector3;

use super::{
    apart_x8::MAX_MARGIN,
    one_rings::{OneRing, OneRingsX8},
    vertex_star_x8::Axis,
};
use crate::{
    intersect::bvh::{PointF32, min},
    simd::F32x8Lanes,
};

/// One bit for each of eight stars that are proven to be clear.
///
/// Each area is one less than its rounding, and each squared length of a link larger by that of its spokes.
#[inline(always)]
pub(crate) fn clear_mask_x8<L: F32x8Lanes>(simd: L, points: &[PointF32], rings: &OneRingsX8<'_>, margin: f32) -> u32 {
    let Some([first, second]) = rings.around.first_chunk() else { return 0 };
    let (zero, one, floor) = (simd.splat(0.0), simd.splat(1.0), simd.splat(L::FLOOR));
    let centre = simd.gather(points, rings.centres);
    let first = simd.sub3(simd.gather(points, first), centre);
    let second = simd.sub3(simd.gather(points, second), centre);
    let axis = Axis::nearest_to(simd, simd.cross(first, second));
    let start = axis.project(simd, first);
    let (mut spoke, mut squared, mut num_turns) = (start, squared(simd, start), zero);
    let (mut min_area, mut min_sine, mut min_height) = (one, one, one);
    for step in 0..rings.around.len() {
        let next = match rings.around.get(step + 1) {
            Some(indices) => axis.project(simd, simd.sub3(simd.gather(points, indices), centre)),
            None => start,
        };
        let next_squared = self::squared(simd, next);
        let terms = [simd.mul(spoke[0], next[1]), simd.mul(spoke[1], next[0])];
        let rounding = simd.mul(simd.splat(8.0 * L::ROUNDOFF), simd.add(simd.abs(terms[0]), simd.abs(terms[1])));
        let area = simd.sub(simd.sub(terms[0], terms[1]), rounding);
        min_area = simd.min(min_area, area);
        let area_squared = simd.mul(area, area);
        let spokes = simd.add(simd.mul(squared, next_squared), floor);
        min_sine = simd.min(min_sine, simd.div(area_squared, spokes));
        let link = self::squared(simd, [simd.sub(next[0], spoke[0]), simd.sub(next[1], spoke[1])]);
        let rounding = simd.mul(simd.splat(16.0 * L::ROUNDOFF), simd.add(squared, next_squared));
        let link = simd.add(simd.add(link, rounding), floor);
        min_height = simd.min(min_height, simd.div(area_squared, link));
        let (before, after) = (simd.sub(zero, spoke[1]), simd.sub(zero, next[1]));
        num_turns = simd.add(num_turns, simd.select(before, simd.select(after, zero, one), zero));
        (spoke, squared) = (next, next_squared);
    }
    let is_one_turn = simd.min(simd.sub(simd.splat(1.5), num_turns), num_turns);
    let margin = simd.splat_f32(min(margin, MAX_MARGIN));
    let needed = simd.mul(simd.mul(margin, margin), simd.splat(1.0 + 64.0 * L::ROUNDOFF));
    let beyond = simd.sub(simd.mul(min_sine, min_height), simd.add(needed, floor));
    simd.gt_zero_mask(simd.min(simd.min(min_area, beyond), is_one_turn))
}

#[inline(always)]
fn squared<L: F32x8Lanes>(simd: L, [x, y]: [L::Vector; 2]) -> L::Vector {
    simd.add(simd.mul(x, x), simd.mul(y, y))
}

/// Whether a star is proven to be clear, in double precision, along its own normal. A fan that does not close is closed
/// by a spoke opposite to it.
///
/// A wedge of a sine below [`LEAST_SINE`] proves nothing: so areas are off by 1e-9 of themselves at most, and what is
/// proven by less than that of the margin.
pub(crate) fn is_clear(points: &[PointF32], ring: OneRing<'_>, margin: f32, spokes: &mut Vec<[f64; 2]>) -> bool {
    project(points, ring, spokes);
    let (mut sine_squared, mut height_squared, mut num_turns) = (1.0_f64, f64::INFINITY, 0);
    let num_links = ring.around.len() - 1;
    for at in 0..spokes.len() {
        let ([a, b], [c, d]) = (spokes[at], spokes[(at + 1) % spokes.len()]);
        let area = a * d - b * c;
        let area_squared = area * area;
        sine_squared = sine_squared.min(area_squared / ((a * a + b * b) * (c * c + d * d)));
        if at < num_links {
            height_squared = height_squared.min(area_squared / ((c - a) * (c - a) + (d - b) * (d - b)));
        }
        num_turns += usize::from(b < 0.0 && d >= 0.0);
        // Not written the other way round: a NaN proves nothing.
        let is_left_turn = area > 0.0;
        if !is_left_turn {
            return false;
        }
    }
    let needed = f64::from(margin) * (1.0 + 1e-7);
    num_turns == 1 && sine_squared > LEAST_SINE * LEAST_SINE && sine_squared * height_squared > needed * needed
}

/// See [`is_clear`].
const LEAST_SINE: f64 = 1e-6;

/// The spokes of a star in turn, along its normal, and one opposite to a fan that does not close.
fn project(points: &[PointF32], ring: OneRing<'_>, spokes: &mut Vec<[f64; 2]>) {
    let at = |vertex: u32| Vector3::from_fn(|axis, _| f64::from(points[vertex as usize][axis]));
    let centre = at(ring.centre.0);
    let spoke = |index: usize| at(ring.around[index].0) - centre;
    let mut normal = Vector3::zeros();
    for index in 1..ring.around.len() {
        normal += spoke(index - 1).cross(&spoke(index));
    }
    // Of NaN where there is no direction.
    let normal = normal.normalize();
    let first = spoke(0).cross(&normal).normalize();
    let second = normal.cross(&first);
    spokes.clear();
    let closes = ring.around.first() == ring.around.last();
    for index in 0..ring.around.len() - usize::from(closes) {
        let spoke = spoke(index);
        spokes.push([first.dot(&spoke), second.dot(&spoke)]);
    }
    if !closes {
        spokes.push(spokes.iter().fold([0.0; 2], |sum, spoke| [sum[0] - spoke[0], sum[1] - spoke[1]]));
    }
}
