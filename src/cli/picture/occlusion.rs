//! Contact shadows.

use super::canvas::Canvas;

/// Offsets of the neighbours in pixels, on two circles.
const NEIGHBOURS: [[f32; 2]; 16] = [
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

/// Depth difference, in pixels, beyond which a nearer neighbour is another object and casts no shadow.
const DEPTH: f32 = 40.0;

/// Darkens samples with nearer neighbours: a contact shadow from the depth buffer alone.
pub(super) fn occlude(canvas: &mut Canvas, samples: usize) {
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
            for [dx, dy] in NEIGHBOURS {
                let (Some(x), Some(y)) = (moved(x, dx * scale, width), moved(y, dy * scale, height)) else { continue };
                // On a slope of 45 degrees the rise equals the distance; only the rise beyond it counts.
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

/// `place + by`, if it is one of `count` samples.
fn moved(place: usize, by: f32, count: usize) -> Option<usize> {
    #[expect(clippy::cast_possible_truncation, reason = "offsets of some tens of samples")]
    let moved = place.checked_add_signed(by as isize)?;
    (moved < count).then_some(moved)
}
