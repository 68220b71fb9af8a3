//! The flat shape of single faces: what a chart is put together from.

use nalgebra::{Point2, Point3, Vector3};

use super::patch::Patch;
use crate::{
    frame::Frame,
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
pub(crate) type Shape = [Point2<f64>; 3];

/// UV triangles with less than this part of the area of an equilateral one of the same longest side are taken for junk.
const SLIVER: f64 = 1e-6;

/// Writes the shape of every face of a patch, and says where it comes from: texture coordinates where all are usable, else rest lengths
/// where there are rest positions, else the lengths of the frame.
pub(crate) fn measure(mesh: &Mesh, frame: &Frame, patch: &Patch, shapes: &mut Vec<Shape>) -> ShapeSource {
    if let Some(uvs) = mesh.uvs() {
        shapes.clear();
        shapes.extend(patch.faces().iter().map(|&face| uv_shape(uvs, face)));
        if shapes.iter().all(is_usable) {
            return ShapeSource::Uvs;
        }
    }
    shapes.clear();
    if let Some(rest) = mesh.rest_positions() {
        shapes.extend(
            patch.faces().iter().map(|&face| flat(mesh.face(face).map(|vertex| Point3::from(rest[vertex.index()])))),
        );
        return ShapeSource::Rest;
    }
    shapes.extend(patch.faces().iter().map(|&face| flat(mesh.face(face).map(|vertex| frame.position(vertex)))));
    ShapeSource::Current
}

fn uv_shape(uvs: &Uvs, face: FaceId) -> Shape {
    uvs.corners[face.index()].map(|corner| Point2::from(uvs.coordinates[corner as usize]))
}

fn is_usable(shape: &Shape) -> bool {
    let [a, b, c] = *shape;
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    (b - a).perp(&(c - a)).abs() > SLIVER * longest
}

/// A triangle of space laid flat: its first corner at the origin, its first side along the first axis.
pub(crate) fn flat([a, b, c]: [Point3<f64>; 3]) -> Shape {
    let side = b - a;
    let length = side.norm();
    let other = c - a;
    let along = if length > 0.0 { side / length } else { Vector3::x() };
    let x = other.dot(&along);
    let height = (other - along * x).norm();
    [Point2::origin(), Point2::new(length, 0.0), Point2::new(x, height)]
}
