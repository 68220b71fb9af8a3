//! The directions in which the faces around a vertex lie: boxes that overlap where faces intersect beyond it.

use nalgebra::{Point3, Vector3};

use super::corners::Corners;

/// More than the rounding of a unit vector and of the steps after it.
const ROUNDING: f64 = 1e-14;

/// A box around the unit vectors from a vertex to the points of one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionBox {
    pub(super) min: [f64; 3],
    pub(super) max: [f64; 3],
    /// Which face it is.
    pub(super) at: u32,
}

impl DirectionBox {
    /// Of a face that starts at the vertex.
    ///
    /// Two faces that intersect beyond the vertex do so along a ray from it. The unit vectors of a face form an arc
    /// between those of its two sides, which is nowhere further from its chord of length c than c^2 / 4.
    fn of(face: &Corners, at: u32) -> Self {
        let [from, a, b] = face.sites.map(|site| Point3::from(site.position));
        let unit = |to: Point3<f64>| -> Option<Vector3<f64>> {
            let offset = to - from;
            let length = offset.norm();
            (length > 0.0).then(|| offset / length)
        };
        let (Some(a), Some(b)) = (unit(a), unit(b)) else {
            // A corner in the vertex lies in any direction.
            return Self { min: [-2.0; 3], max: [2.0; 3], at };
        };
        let room = (b - a).norm_squared() / 4.0 + ROUNDING;
        let min = std::array::from_fn(|axis| a[axis].min(b[axis]) - room);
        Self { min, max: std::array::from_fn(|axis| a[axis].max(b[axis]) + room), at }
    }
}

/// Takes the directions of faces, in the order in which a sweep along the first axis meets them.
pub(super) fn sort_directions(faces: &[Corners], directions: &mut Vec<DirectionBox>) {
    directions.clear();
    directions.extend((0..).zip(faces).map(|(at, face)| DirectionBox::of(face, at)));
    directions.sort_unstable_by(|a, b| a.min[0].total_cmp(&b.min[0]).then(a.at.cmp(&b.at)));
}
