//! The map of a frame into single precision.

use nalgebra::Point3;
use rayon::prelude::*;

/// A vertex after the map; the fourth component makes a point one load, and marks one that is far.
pub(crate) type PointF32 = [f32; 4];

/// Least number of vertices that one thread takes at a time.
const MIN_VERTICES_PER_TASK: usize = 4096;

/// Vertices by which the core of a frame is found.
const NUM_SAMPLES: usize = 255;

/// The core reaches beyond the middle half of the samples by so many times its own extent.
const CORE_BEYOND: f64 = 8.0;

/// Where the whole extends further than so many times the core, the core alone gets the resolution.
const LARGEST_TO_CORE: f64 = 1024.0;

/// The map `x -> f32((x - centre) * scale)`, each of whose steps is monotone.
///
/// It takes the whole frame to between minus and plus one half; but where a few vertices are so far away that the rest
/// would come to lie in one point, as after a step of a solver that blew up, it takes the rest there.
pub(super) struct SingleMap {
    centre: [f64; 3],
    /// One over the largest extent of what comes to between minus and plus one half, in metres.
    pub(super) scale: f64,
    /// Whether there are vertices beyond that. They are marked, see [`is_far`].
    pub(super) has_far: bool,
}

impl SingleMap {
    /// The map for the vertices of a frame.
    ///
    /// Cost: linear in the vertices, in parallel.
    pub(super) fn of(positions: &[Point3<f64>]) -> Self {
        let bounds = bounds(positions);
        let core = core(positions);
        let [whole, middle] = [extent(&bounds), extent(&core)];
        let has_far = middle > 0.0 && whole > LARGEST_TO_CORE * middle;
        let ([low, high], extent) = if has_far { (core, middle) } else { (bounds, whole) };
        let centre = std::array::from_fn(|axis| low[axis].midpoint(high[axis]));
        // Where all vertices are in one point any scale is right.
        Self { centre, scale: if extent > 0.0 { 1.0 / extent } else { 1.0 }, has_far }
    }

    /// Maps all vertices.
    ///
    /// Cost: linear in the vertices, in parallel.
    pub(super) fn apply(&self, positions: &[Point3<f64>], points: &mut Vec<PointF32>) {
        points.resize(positions.len(), PointF32::default());
        let (centre, scale) = (self.centre, self.scale);
        let pairs = points.par_iter_mut().with_min_len(MIN_VERTICES_PER_TASK).zip(positions);
        if self.has_far {
            pairs.for_each(|(point, position)| {
                let mapped: [f64; 3] = std::array::from_fn(|axis| (position[axis] - centre[axis]) * scale);
                // Finite, since an empty slot of a node ends at minus infinity.
                let [x, y, z] = mapped.map(|along| to_single(along.clamp(f64::from(f32::MIN), f64::from(f32::MAX))));
                *point = [x, y, z, if mapped.iter().all(|along| along.abs() <= 0.5) { 0.0 } else { 1.0 }];
            });
        } else {
            pairs.for_each(|(point, position)| {
                let map = |axis: usize| to_single((position[axis] - centre[axis]) * scale);
                *point = [map(0), map(1), map(2), 0.0];
            });
        }
    }
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

/// Lowest and highest coordinates.
fn bounds(positions: &[Point3<f64>]) -> [[f64; 3]; 2] {
    let empty = || [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let union = |a: [[f64; 3]; 2], b: [[f64; 3]; 2]| {
        let low = std::array::from_fn(|axis| a[0][axis].min(b[0][axis]));
        [low, std::array::from_fn(|axis| a[1][axis].max(b[1][axis]))]
    };
    let boxes = positions.par_chunks(MIN_VERTICES_PER_TASK).map(|chunk| {
        chunk.iter().fold(empty(), |aabb, &position| {
            let position: [f64; 3] = position.into();
            union(aabb, [position, position])
        })
    });
    boxes.reduce(empty, union)
}

/// A box round most of the vertices, by the middle half of some of them: up to a quarter may be anywhere.
fn core(positions: &[Point3<f64>]) -> [[f64; 3]; 2] {
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
fn extent([low, high]: &[[f64; 3]; 2]) -> f64 {
    (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(count: u32) -> Vec<Point3<f64>> {
        (0..count).map(|at| Point3::new(f64::from(at), 0.0, 0.0)).collect()
    }

    #[test]
    fn single_map_of_a_frame_without_far_vertices_takes_all_to_one_half_at_most() {
        let mut points = Vec::new();
        for count in [0, 1, 2, 1000] {
            let positions = line(count);
            let map = SingleMap::of(&positions);
            map.apply(&positions, &mut points);
            assert!(!map.has_far && points.iter().all(|point| point[0].abs() <= 0.5 && !is_far(*point)));
        }
    }

    #[test]
    fn single_map_with_a_vertex_far_away_tells_the_others_apart_and_keeps_the_order() {
        for far in [1e9, 1e12, -1e60, 1e75] {
            let mut positions = line(1000);
            positions[1] = Point3::new(far, 0.0, far);
            let map = SingleMap::of(&positions);
            let mut points = Vec::new();
            map.apply(&positions, &mut points);
            assert!(map.has_far && points.iter().enumerate().all(|(at, &point)| is_far(point) == (at == 1)));
            assert!(points[2..].is_sorted_by(|a, b| a[0] < b[0]) && points[1].iter().all(|along| along.is_finite()));
            assert_eq!(points[1][0] > points[999][0], far > 0.0);
        }
    }
}
