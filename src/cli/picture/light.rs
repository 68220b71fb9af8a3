//! The light of a studio on cloth.

use nalgebra::Vector3;

use super::theme::{Colour, single};

/// Colour of a piece of cloth under the studio lights. `normal` is in the viewer's axes and need not have unit length;
/// `back` tells that the back side is seen; `to_side` is the distance to the nearest side of the triangle, in samples.
pub(super) fn shade(colour: Colour, normal: Vector3<f64>, back: bool, to_side: f32) -> Colour {
    // The normal of the side that faces the viewer, for either order of the vertices.
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
