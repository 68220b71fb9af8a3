//! The flat shapes of single faces: the parts that a chart is put together from.

use nalgebra::{Point2, Point3, Vector2};

use super::patch::Patch;
use crate::{
    frame::Frame,
    geometry::flat_triangle,
    mesh::{FaceId, Mesh, Uvs},
};

/// Where the shapes of a chart come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeSource {
    /// The texture coordinates of the mesh.
    Uvs,
    /// The lengths of its rest positions.
    Rest,
    /// The lengths of the frame itself.
    Current,
}

/// A face in a plane of its own: corner by corner, in the order of the face.
pub(super) type Shape = [Point2<f64>; 3];

/// UV triangles whose doubled area is below this part of the square of their longest side are degenerate, and not used.
const SLIVER: f64 = 1e-6;

/// Writes the shape of every face of a patch, and says where it comes from: texture coordinates where all are usable,
/// else rest lengths where there are rest positions, else the lengths of the frame.
pub(super) fn measure(mesh: &Mesh, frame: &Frame, patch: &Patch, shapes: &mut Vec<Shape>) -> ShapeSource {
    if let Some(uvs) = mesh.uvs() {
        shapes.clear();
        shapes.extend(patch.faces().iter().map(|&face| uv_shape(uvs, face)));
        if shapes.iter().all(is_usable) {
            return ShapeSource::Uvs;
        }
    }
    shapes.clear();
    if let Some(rest) = mesh.rest_positions() {
        let corners = |&face: &FaceId| mesh.face(face).map(|vertex| Point3::from(rest[vertex.index()]));
        shapes.extend(patch.faces().iter().map(|face| flat_triangle(corners(face))));
        return ShapeSource::Rest;
    }
    let corners = |&face: &FaceId| mesh.face(face).map(|vertex| frame.position(vertex));
    shapes.extend(patch.faces().iter().map(|face| flat_triangle(corners(face))));
    ShapeSource::Current
}

/// Writes the place of each vertex of a patch in the smooth chart of its piece. False where there is none, or a face is
/// not usable there.
pub(super) fn smooth_places(mesh: &Mesh, patch: &Patch, places: &mut Vec<Point2<f64>>) -> bool {
    if mesh.uvs().is_none() {
        return false;
    }
    places.clear();
    places.extend(patch.vertices().iter().map_while(|&vertex| mesh.chart_place(vertex).map(Point2::from)));
    places.len() == patch.vertices().len()
        && patch.corners().iter().all(|corners| is_usable(&corners.map(|corner| places[corner as usize])))
}

/// The sides of a shape as vectors, side `k` from corner `k` to the next.
pub(super) fn sides_of(shape: &Shape) -> [Vector2<f64>; 3] {
    [shape[1] - shape[0], shape[2] - shape[1], shape[0] - shape[2]]
}

fn uv_shape(uvs: &Uvs, face: FaceId) -> Shape {
    uvs.corners[face.index()].map(|corner| Point2::from(uvs.coordinates[corner as usize]))
}

fn is_usable(shape: &Shape) -> bool {
    let [a, b, c] = *shape;
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    (b - a).perp(&(c - a)).abs() > SLIVER * longest
}
