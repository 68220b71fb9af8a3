//! Closest points of a surface, and rays against it: parry's tree of triangles.

use std::fmt::{self, Debug, Formatter};

use nalgebra::{Point3, Vector3};
use parry3d_f64::{
    math::Vector,
    query::{PointQueryWithLocation, Ray, RayCast},
    shape::{TriMesh, TrianglePointLocation},
};

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePlace {
    /// The number of the triangle.
    pub(super) triangle: usize,
    pub(super) barycentric: [f64; 3],
    pub(super) point: Point3<f64>,
}

/// Triangles in parry's tree.
pub(super) struct Surface {
    mesh: TriMesh,
}

impl Debug for Surface {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Surface").field("num_triangles", &self.mesh.num_triangles()).finish()
    }
}

impl Surface {
    /// Nothing without triangles. Cost: O(n log n).
    pub(super) fn new(triangles: &[[Point3<f64>; 3]]) -> Option<Self> {
        let corners = triangles.iter().flatten().map(|corner| vector(corner.coords)).collect();
        let count = u32::try_from(triangles.len()).expect("limited at construction");
        let indices = (0..count).map(|triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2]).collect();
        TriMesh::new(corners, indices).ok().map(|mesh| Self { mesh })
    }

    /// The closest point of all triangles that are allowed.
    pub(super) fn closest(&self, at: Point3<f64>, is_allowed: impl Fn(usize) -> bool) -> Option<SurfacePlace> {
        let point = vector(at.coords);
        let to_triangle = |triangle: u32, _: f64| {
            is_allowed(triangle as usize).then(|| {
                let found = self.mesh.triangle(triangle).project_local_point_and_get_location(point, false);
                ((found.0.point - point).length(), found)
            })
        };
        let bvh = self.mesh.bvh();
        let found = bvh.find_best(
            f64::MAX,
            |node, _| {
                let (low, high) = (node.mins(), node.maxs());
                (point.clamp(low, high) - point).length()
            },
            to_triangle,
        );
        found.map(|(triangle, (_, (projection, location)))| {
            let barycentric = weights(location);
            SurfacePlace { triangle: triangle as usize, barycentric, point: place(projection.point) }
        })
    }

    /// The first point of all triangles along a ray.
    pub(super) fn along(&self, from: Point3<f64>, direction: Vector3<f64>) -> Option<SurfacePlace> {
        let ray = Ray::new(vector(from.coords), vector(direction));
        let hit = self.mesh.cast_local_ray_and_get_normal(&ray, f64::MAX, false)?;
        let point = ray.point_at(hit.time_of_impact);
        let triangle = hit.subshape;
        let location = self.mesh.triangle(triangle).project_local_point_and_get_location(point, false).1;
        Some(SurfacePlace { triangle: triangle as usize, barycentric: weights(location), point: place(point) })
    }
}

fn weights(location: TrianglePointLocation) -> [f64; 3] {
    location.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0])
}

fn vector(at: Vector3<f64>) -> Vector {
    Vector::new(at.x, at.y, at.z)
}

fn place(at: Vector) -> Point3<f64> {
    Point3::new(at.x, at.y, at.z)
}
