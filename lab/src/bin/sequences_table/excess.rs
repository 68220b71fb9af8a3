//! How abruptly vertices move in the output of a shot beyond what they did in its input.

use nalgebra::Vector3;
use untangle::coherence::Fade;

use super::scene::Scene;

/// Bytes of a PC2 file before its frames, and of a vertex.
pub(crate) const HEADER_SIZE: usize = 32;
pub(crate) const VERTEX_SIZE: usize = 12;

/// Second differences of the ways of vertices from frame to frame, beyond those of the input in the same frame and that
/// of a smooth bump as high as the largest correction of the vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Excess {
    /// The largest, in metres; not below 0.
    pub(crate) max_m: f64,
    /// Vertices that have any, by more than rounding to single precision may give.
    pub(crate) num_beyond: usize,
    /// Vertices that are corrected in some frame.
    pub(crate) num_corrected: usize,
}

impl Excess {
    /// Compares the bytes of two caches.
    pub(crate) fn of(scene: &Scene, input: &[u8], output: &[u8]) -> Self {
        let fade = Fade { num_frames: 8 };
        let mut excess = Self::default();
        for vertex in 0..scene.num_vertices {
            let way = |bytes: &[u8]| -> Vec<Vector3<f64>> {
                (0..scene.num_frames).map(|frame| position(scene.num_vertices, bytes, frame, vertex)).collect()
            };
            let (before, after) = (way(input), way(output));
            let height = before.iter().zip(&after).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
            let largest = after.iter().map(Vector3::amax).fold(0.0, f64::max);
            let second = |way: &[Vector3<f64>]| (way[0] - way[1] * 2.0 + way[2]).norm();
            let pairs = before.windows(3).zip(after.windows(3));
            let beyond = pairs.map(|(before, after)| second(after) - second(before)).fold(0.0, f64::max)
                - fade.smooth_second_difference(height);
            excess.max_m = excess.max_m.max(beyond);
            excess.num_corrected += usize::from(height > 0.0);
            // Each of the four places of a second difference is rounded by half a last place.
            excess.num_beyond += usize::from(beyond > 4.0 * f64::from(f32::EPSILON) * largest);
        }
        excess
    }
}

/// Where a vertex is in a frame of a cache.
pub(crate) fn position(num_vertices: usize, bytes: &[u8], frame: usize, vertex: usize) -> Vector3<f64> {
    let start = HEADER_SIZE + VERTEX_SIZE * (frame * num_vertices + vertex);
    Vector3::from_fn(|axis, _| {
        let at = start + 4 * axis;
        f64::from(f32::from_le_bytes(std::array::from_fn(|byte| bytes[at + byte])))
    })
}
