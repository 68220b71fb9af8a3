//! Where a vertex that a coarser mesh has no more lies on what is left.

use nalgebra::{Point3, Vector3};
use parry3d_f64::{math::Vector, query::PointQueryWithLocation, shape::Triangle};

/// A vertex that was removed, and its place on a triangle of vertices that were still there: a point of it, and an
/// offset that turns with the triangle (detail coefficients, Kobbelt et al. 1998).
#[derive(Clone, Copy, Debug)]
pub(super) struct RemovedVertex {
    pub(super) vertex: u32,
    corners: [u32; 3],
    barycentric: [f64; 3],
    /// Along the first side of the triangle, along its normal, and across both, in metres.
    offset_m: Vector3<f64>,
}

impl RemovedVertex {
    /// On the nearest of some triangles, the first of equals; nothing without any.
    pub(super) fn on_nearest(vertex: u32, triangles: &[[u32; 3]], positions: &[Point3<f64>]) -> Option<Self> {
        let at = positions[vertex as usize];
        let placed = triangles.iter().map(|&corners| {
            let places = corners.map(|corner| positions[corner as usize]);
            let [a, b, c] = places.map(vector);
            let (_, location) = Triangle::new(a, b, c).project_local_point_and_get_location(vector(at), false);
            let barycentric = location.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0]);
            let offset = at - on_triangle(places, barycentric);
            let offset_m = axes(places).map_or(Vector3::zeros(), |axes| axes.map(|axis| axis.dot(&offset)).into());
            (offset.norm_squared(), Self { vertex, corners, barycentric, offset_m })
        });
        placed.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, removed)| removed)
    }

    /// Where it is, where its triangle has these corners.
    pub(super) fn place(&self, positions: &[Point3<f64>]) -> Point3<f64> {
        let places = self.corners.map(|corner| positions[corner as usize]);
        let [x, y, z] = self.offset_m.into();
        let offset =
            axes(places).map_or(Vector3::zeros(), |[along, normal, across]| along * x + normal * y + across * z);
        on_triangle(places, self.barycentric) + offset
    }
}

fn vector(at: Point3<f64>) -> Vector {
    Vector::new(at.x, at.y, at.z)
}

fn on_triangle([a, b, c]: [Point3<f64>; 3], [_, second, third]: [f64; 3]) -> Point3<f64> {
    a + (b - a) * second + (c - a) * third
}

/// The directions in which an offset is given; nothing for a triangle without an area.
fn axes([a, b, c]: [Point3<f64>; 3]) -> Option<[Vector3<f64>; 3]> {
    let along = (b - a).try_normalize(0.0)?;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some([along, normal, along.cross(&normal)])
}
