//! How smooth corrections are in time.
//!
//! The measure is the second difference of a vertex's correction from frame to frame, in directions of the material.
//! Beside it stands what a smooth bump of that height needs: one that grows in and fades out by the movement of least
//! jerk, over the window of the fade. The ratio of both is 1 for a smooth bump, whatever its height. A correction that
//! is there in one frame only has a second difference of twice its height: `2 (n + 1)^2 / 5.77` for a window of `n`
//! frames, 28 for 8.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::Serialize;

use super::{SparseField, fade::Fade};

/// The measure of a shot. What needs second differences is nothing for fewer than three frames, which have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Roughness {
    /// Vertices that are corrected in some frame.
    pub num_vertices: usize,
    /// Largest correction, in metres.
    pub max_correction_m: f64,
    /// Largest second difference of a correction, in metres for each frame squared.
    pub max_second_difference_m: Option<f64>,
    /// For the worst vertex its largest second difference, divided by that of a smooth bump as high as its correction.
    pub max_ratio_to_smooth: Option<f64>,
    /// The same for 99 of 100 vertices.
    pub p99_ratio_to_smooth: Option<f64>,
    /// The same on the mean.
    pub mean_ratio_to_smooth: Option<f64>,
}

/// Takes corrections frame by frame.
#[derive(Clone, Debug)]
pub struct RoughnessMeter {
    fade: Fade,
    resolution_m: f64,
    num_frames: u64,
    before: [SparseField; 2],
    vertices: BTreeMap<u32, Extremes>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Extremes {
    height_m: f64,
    second_difference_m: f64,
}

impl RoughnessMeter {
    /// Second differences below four times the resolution, which is that of the numbers in the files, count as none.
    #[must_use]
    pub fn new(fade: Fade, resolution_m: f64) -> Self {
        Self { fade, resolution_m, num_frames: 0, before: Default::default(), vertices: BTreeMap::new() }
    }

    /// Takes the corrections of the next frame, in directions of the material.
    pub fn push(&mut self, field: SparseField) {
        let [first, second] = &self.before;
        for (&vertex, vector) in &field {
            let own = self.vertices.entry(vertex).or_default();
            own.height_m = own.height_m.max(vector.norm());
        }
        self.num_frames += 1;
        // At the ends of a shot nothing is known of the frames beyond.
        if self.is_measured() {
            let at = |field: &SparseField, vertex| field.get(&vertex).copied().unwrap_or_else(Vector3::zeros);
            for vertex in first.keys().chain(second.keys()).chain(field.keys()) {
                let difference = at(first, *vertex) - at(second, *vertex) * 2.0 + at(&field, *vertex);
                let own = self.vertices.entry(*vertex).or_default();
                own.second_difference_m = own.second_difference_m.max(difference.norm());
            }
        }
        let [first, second] = &mut self.before;
        std::mem::swap(first, second);
        *second = field;
    }

    /// Whether there are frames enough for a second difference.
    fn is_measured(&self) -> bool {
        self.num_frames > 2
    }

    /// The measure of all frames so far.
    #[must_use]
    pub fn roughness(&self) -> Roughness {
        let ratio = |own: &Extremes| {
            let beyond = (own.second_difference_m - 4.0 * self.resolution_m).max(0.0);
            beyond / self.fade.smooth_second_difference(own.height_m).max(f64::MIN_POSITIVE)
        };
        let mut ratios: Vec<f64> = self.vertices.values().map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let largest = |value: fn(&Extremes) -> f64| self.vertices.values().map(value).fold(0.0, |a: f64, b| a.max(b));
        #[expect(clippy::cast_precision_loss, reason = "numbers of vertices")]
        let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
        let p99 = ratios.get((ratios.len() * 99).div_ceil(100).saturating_sub(1));
        let measured = |value: f64| self.is_measured().then_some(value);
        Roughness {
            num_vertices: ratios.len(),
            max_correction_m: largest(|own| own.height_m),
            max_second_difference_m: measured(largest(|own| own.second_difference_m)),
            max_ratio_to_smooth: measured(ratios.last().copied().unwrap_or(0.0)),
            p99_ratio_to_smooth: measured(p99.copied().unwrap_or(0.0)),
            mean_ratio_to_smooth: measured(mean),
        }
    }
}
