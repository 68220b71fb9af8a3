//! The map of a frame into single precision.

use nalgebra::Point3;
use rayon::prelude::*;

use crate::{
    frame::BodyVersion,
    mesh::{Mesh, VERTICES_PER_BLOCK},
};

/// A vertex after the map; the fourth component makes a point one load, and marks one that is far.
pub(crate) type PointF32 = [f32; 4];

/// Least number of blocks of vertices that one thread takes at a time.
const MIN_BLOCKS_PER_TASK: usize = 4;

/// Vertices by which the core of a frame is found.
const NUM_SAMPLES: usize = 255;

/// The core reaches beyond the middle half of the samples by so many times its own extent.
const CORE_BEYOND: f64 = 8.0;

/// Where the whole extends further than so many times the core, the core alone gets the resolution.
const LARGEST_TO_CORE: f64 = 1024.0;

/// With bodies, the centre of the map is a multiple of this part of what it takes to one.
const CENTRE_GRID: f64 = 1.0 / 16.0;

/// The map `x -> f32((x - centre) * scale)`, each of whose steps is monotone.
///
/// It takes the whole frame to between minus and plus one half; but where a few vertices are so far away that the rest
/// would come to lie in one point, as after a step of a solver that blew up, it takes the rest there.
///
/// With bodies it is one of few maps, so that it is mostly that of the frame before, and what was made of bodies that
/// stay holds. It follows from the positions alone, as all that is counted of boxes has to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SingleMap {
    centre: [f64; 3],
    /// One over the largest extent of what comes to between minus and plus one half, in metres.
    pub(super) scale: f64,
    /// Whether there are vertices beyond that. They are marked, see [`is_far`].
    pub(super) has_far: bool,
}

/// Lowest and highest coordinates, in metres.
pub(super) type Bounds = [[f64; 3]; 2];

/// What a tree was fitted to last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fitted {
    pub(super) map: SingleMap,
    /// Where bodies were, and the bounds of blocks of their vertices.
    pub(super) body: BodyVersion,
    pub(super) body_bounds: Bounds,
}

impl SingleMap {
    /// The map for the vertices of a frame within some bounds. `is_of_few` is for meshes with bodies.
    pub(super) fn of(positions: &[Point3<f64>], bounds: Bounds, is_of_few: bool) -> Self {
        let core = core(positions);
        let [whole, middle] = [extent(&bounds), extent(&core)];
        let has_far = middle > 0.0 && whole > LARGEST_TO_CORE * middle;
        let ([low, high], extent) = if has_far { (core, middle) } else { (bounds, whole) };
        let centre = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        // Where all vertices are in one point any scale is right.
        let map = Self { centre, scale: if extent > 0.0 { 1.0 / extent } else { 1.0 }, has_far };
        if is_of_few && extent > 0.0 { map.of_few(extent) } else { map }
    }

    /// The next of few maps: its scale is a power of two, and its centre on a grid.
    fn of_few(self, extent: f64) -> Self {
        // So much more that the frame stays within one half wherever it lies between two centres.
        let one_m = next_power_of_two(extent / (1.0 - CENTRE_GRID));
        let step_m = one_m * CENTRE_GRID;
        // By powers of two, so that nothing is rounded but to the grid.
        let centre = self.centre.map(|along| (along / step_m).round() * step_m);
        Self { centre, scale: 1.0 / one_m, ..self }
    }

    /// Maps all vertices, but for blocks that are left out.
    ///
    /// Cost: linear in the vertices, in parallel.
    pub(super) fn apply(
        &self,
        positions: &[Point3<f64>],
        is_left_out: impl Fn(usize) -> bool + Sync,
        points: &mut Vec<PointF32>,
    ) {
        points.resize(positions.len(), PointF32::default());
        let (centre, scale) = (self.centre, self.scale);
        let blocks = points.par_chunks_mut(VERTICES_PER_BLOCK).zip(positions.par_chunks(VERTICES_PER_BLOCK));
        let blocks = blocks.with_min_len(MIN_BLOCKS_PER_TASK).enumerate();
        let pairs =
            blocks.filter(|(block, _)| !is_left_out(*block)).map(|(_, (points, places))| points.iter_mut().zip(places));
        if self.has_far {
            pairs.for_each(|pairs| {
                pairs.for_each(|(point, position)| {
                    let mapped: [f64; 3] = std::array::from_fn(|axis| (position[axis] - centre[axis]) * scale);
                    // Finite, since an empty slot of a node ends at minus infinity.
                    let [x, y, z] =
                        mapped.map(|along| to_single(along.clamp(f64::from(f32::MIN), f64::from(f32::MAX))));
                    *point = [x, y, z, if mapped.iter().all(|along| along.abs() <= 0.5) { 0.0 } else { 1.0 }];
                })
            });
        } else {
            pairs.for_each(|pairs| {
                pairs.for_each(|(point, position)| {
                    let map = |axis: usize| to_single((position[axis] - centre[axis]) * scale);
                    *point = [map(0), map(1), map(2), 0.0];
                })
            });
        }
    }
}

/// The least power of two that is not less than a positive number in the range of a frame's lengths.
fn next_power_of_two(number: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    let floor = f64::from_bits(number.to_bits() & !MANTISSA);
    if floor < number { 2.0 * floor } else { floor }
}

/// Whether a vertex is beyond what the map resolves: its coordinates keep the order of boxes, but are off by more than
/// the filters in single precision know of.
#[inline(always)]
pub(super) fn is_far(point: PointF32) -> bool {
    point[3] > 0.0
}

#[expect(clippy::cast_possible_truncation, reason = "monotone, which is all that is needed")]
fn to_single(along: f64) -> f32 {
    along as f32
}

/// The bounds of no vertex.
const NO_BOUNDS: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Bounds of the vertices of a frame. `of_bodies` are those of blocks of bodies: where these are still they are known,
/// else they are found.
///
/// Cost: linear in the vertices that are looked at, in parallel.
pub(super) fn bounds_of(
    mesh: &Mesh,
    positions: &[Point3<f64>],
    are_bodies_still: bool,
    of_bodies: &mut Bounds,
) -> Bounds {
    let of_blocks = |are_bodies: bool| {
        let blocks = positions.par_chunks(VERTICES_PER_BLOCK).with_min_len(MIN_BLOCKS_PER_TASK).enumerate();
        let blocks = blocks.filter(|(block, _)| mesh.is_body_block(*block) == are_bodies);
        blocks.map(|(_, places)| bounds(places)).reduce(|| NO_BOUNDS, union)
    };
    if !mesh.has_body() {
        *of_bodies = NO_BOUNDS;
    } else if !are_bodies_still {
        *of_bodies = of_blocks(true);
    }
    union(of_blocks(false), *of_bodies)
}

fn bounds(positions: &[Point3<f64>]) -> Bounds {
    positions.iter().fold(NO_BOUNDS, |bounds, &position| {
        let position: [f64; 3] = position.into();
        union(bounds, [position, position])
    })
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    let low = std::array::from_fn(|axis| a[0][axis].min(b[0][axis]));
    [low, std::array::from_fn(|axis| a[1][axis].max(b[1][axis]))]
}

/// A box round most of the vertices, by the middle half of some of them: up to a quarter may be anywhere.
fn core(positions: &[Point3<f64>]) -> Bounds {
    let mut samples = [0.0; NUM_SAMPLES];
    let count = NUM_SAMPLES.min(positions.len());
    if count == 0 {
        return [[0.0; 3]; 2];
    }
    let middle: [[f64; 2]; 3] = std::array::from_fn(|axis| {
        for (place, sample) in samples[..count].iter_mut().enumerate() {
            *sample = positions[place * positions.len() / count][axis];
        }
        let mut quantile = |at: usize| *samples[..count].select_nth_unstable_by(at, f64::total_cmp).1;
        [quantile(count / 4), quantile(count - 1 - count / 4)]
    });
    let beyond = CORE_BEYOND * middle.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    [middle.map(|[low, _]| low - beyond), middle.map(|[_, high]| high + beyond)]
}

/// The largest extent of a box.
fn extent([low, high]: &Bounds) -> f64 {
    (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(count: u32) -> Vec<Point3<f64>> {
        (0..count).map(|at| Point3::new(f64::from(at), 0.0, 0.0)).collect()
    }

    fn map_of(positions: &[Point3<f64>], is_of_few: bool) -> SingleMap {
        SingleMap::of(positions, bounds(positions), is_of_few)
    }

    #[test]
    fn single_map_of_a_frame_without_far_vertices_takes_all_to_one_half_at_most() {
        let mut points = Vec::new();
        for (count, is_of_few) in [0, 1, 2, 1000, 15].into_iter().flat_map(|count| [(count, false), (count, true)]) {
            for shift in [0.0, 0.4, 7e8, -3e-9] {
                let positions: Vec<_> = line(count).iter().map(|at| at.map(|along| along + shift)).collect();
                let map = map_of(&positions, is_of_few);
                map.apply(&positions, |_| false, &mut points);
                assert!(!map.has_far && points.iter().all(|point| point[0].abs() <= 0.5 && !is_far(*point)));
            }
        }
    }

    #[test]
    fn single_map_with_bodies_is_mostly_the_same_and_resolves_at_least_half_as_much() {
        let mut maps = Vec::new();
        for step in 0..100 {
            let mut positions = line(1000);
            positions[999].x += 0.01 * f64::from(step);
            let [of_few, of_many] = [true, false].map(|is_of_few| map_of(&positions, is_of_few));
            assert!(of_few.scale <= of_many.scale && of_few.scale > 0.46 * of_many.scale);
            maps.push(of_few);
        }
        maps.dedup();
        assert!(maps.len() <= 2, "{maps:?}");
    }

    #[test]
    fn single_map_leaves_out_blocks() {
        let positions = line(u32::try_from(3 * VERTICES_PER_BLOCK).unwrap());
        let mut points = Vec::new();
        map_of(&positions, true).apply(&positions, |block| block == 1, &mut points);
        for (block, points) in points.chunks(VERTICES_PER_BLOCK).enumerate() {
            assert_eq!(points.iter().flatten().all(|along| along.to_bits() == 0), block == 1);
        }
    }

    #[test]
    fn single_map_with_a_vertex_far_away_tells_the_others_apart_and_keeps_the_order() {
        for (far, is_of_few) in [1e9, 1e12, -1e60, 1e75].into_iter().flat_map(|far| [(far, false), (far, true)]) {
            let mut positions = line(1000);
            positions[1] = Point3::new(far, 0.0, far);
            let map = map_of(&positions, is_of_few);
            let mut points = Vec::new();
            map.apply(&positions, |_| false, &mut points);
            assert!(map.has_far && points.iter().enumerate().all(|(at, &point)| is_far(point) == (at == 1)));
            assert!(points[2..].is_sorted_by(|a, b| a[0] < b[0]) && points[1].iter().all(|along| along.is_finite()));
            assert_eq!(points[1][0] > points[999][0], far > 0.0);
        }
    }
}
