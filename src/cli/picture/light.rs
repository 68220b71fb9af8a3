//! How cloth takes light.

use nalgebra::Vector3;

use super::{Colour, raster::Canvas};

/// Colour of a piece of cloth under the studio lights. `normal` is seen from the viewer and need not have unit length; `back` tells that the
/// back side is seen; `to_side` is the distance to the nearest side of the triangle, in samples.
pub(super) fn shade(colour: Colour, normal: Vector3<f64>, back: bool, to_side: f32) -> Colour {
    // Seen from the side that faces the viewer, whatever the order of the vertices.
    let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let normal = if normal.z < 0.0 { -normal } else { normal };
    let key = Vector3::new(-0.45, 0.65, 0.6).normalize();
    let fill = Vector3::new(0.8, 0.1, 0.55).normalize();
    let lambert = |light: &Vector3<f64>| normal.dot(light).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let sheen = (1.0 - normal.z).powi(3);
    let light = single(0.44 + 0.18 * sky + 0.42 * lambert(&key) + 0.14 * lambert(&fill));
    let base = if back { colour * 0.82 } else { colour };
    let line = 1.0 - 0.13 * (1.0 - to_side / 1.5).clamp(0.0, 1.0);
    (base * light + Colour::repeat(single(0.10 * sheen))) * line
}

/// Darkens samples that have something nearer around them: a contact shadow from the depth buffer alone.
pub(super) fn occlude(canvas: &mut Canvas, samples: usize) {
    /// Offsets in pixels, on two rings.
    const RING: [[f32; 2]; 16] = [
        [5.0, 0.0],
        [3.5, 3.5],
        [0.0, 5.0],
        [-3.5, 3.5],
        [-5.0, 0.0],
        [-3.5, -3.5],
        [0.0, -5.0],
        [3.5, -3.5],
        [11.0, 4.6],
        [4.6, 11.0],
        [-4.6, 11.0],
        [-11.0, 4.6],
        [-11.0, -4.6],
        [-4.6, -11.0],
        [4.6, -11.0],
        [11.0, -4.6],
    ];
    /// Nearness over which an occluder counts, in pixels: beyond, it is another object far in front.
    const DEPTH: f32 = 40.0;
    #[expect(clippy::cast_precision_loss, reason = "a handful of samples")]
    let scale = samples as f32;
    let [width, height] = canvas.size();
    let mut factors = vec![1.0_f32; width * height];
    for y in 0..height {
        for x in 0..width {
            let here = canvas.nearness(x, y);
            if here == f32::NEG_INFINITY {
                continue;
            }
            let mut covered = 0.0;
            for [dx, dy] in RING {
                let (Some(x), Some(y)) = (moved(x, dx * scale, width), moved(y, dy * scale, height)) else { continue };
                // On a slope one neighbour is nearer and the opposite one farther: only what exceeds the slope's own rise counts.
                let rise = (canvas.nearness(x, y) - here) / scale - dx.hypot(dy);
                if rise > 0.0 {
                    covered += (rise / 4.0).min(1.0) * (1.0 - rise / DEPTH).max(0.0);
                }
            }
            factors[y * width + x] = 1.0 - 0.55 * (covered / 16.0).min(1.0);
        }
    }
    for y in 0..height {
        for x in 0..width {
            canvas.shade(x, y, factors[y * width + x]);
        }
    }
}

fn moved(place: usize, by: f32, count: usize) -> Option<usize> {
    #[expect(clippy::cast_possible_truncation, reason = "offsets of some tens of samples")]
    let moved = place.checked_add_signed(by as isize)?;
    (moved < count).then_some(moved)
}

#[expect(clippy::cast_possible_truncation, reason = "colours need no more than single precision")]
fn single(value: f64) -> f32 {
    value as f32
}
