//! Where an edge pierces a face: coordinates in floating point, after the signs have decided that it does.

use nalgebra::{Point3, Vector3};

use super::contact::Crossing;
use crate::{frame::Frame, intersect::intersections::EdgeFaceIntersection, mesh::Mesh};

/// Computes the position of a crossing from its edge and face alone, with the corners in the order of their vertices:
/// every pair of faces that shares the crossing gets the same numbers, and no rounding depends on how a face is written
/// down.
///
/// All weights are ratios of volumes of equal sign, hence between 0 and 1 and free of scale. Where all volumes
/// underflow to zero, the middle of the edge or face is taken.
pub(crate) fn locate(mesh: &Mesh, frame: &Frame, (edge, face): Crossing) -> EdgeFaceIntersection {
    let [p, q] = mesh.edge(edge).map(|vertex| frame.position(vertex));
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&corner| mesh.face(face)[corner]);
    let corners = order.map(|corner| frame.position(mesh.face(face)[corner]));
    let along: Vector3<f64> = q - p;
    let [a, b, c] = corners.map(|corner| corner - p);

    let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
    let (from_p, from_q) = (normal.dot(&(corners[0] - p)).abs(), normal.dot(&(corners[0] - q)).abs());
    let edge_parameter = ratio(from_p, from_p + from_q, 0.5);

    let volumes = [along.dot(&b.cross(&c)).abs(), along.dot(&c.cross(&a)).abs(), along.dot(&a.cross(&b)).abs()];
    let total = volumes[0] + volumes[1] + volumes[2];
    let first = ratio(volumes[0], total, 1.0 / 3.0);
    let second = ratio(volumes[1], total, 1.0 / 3.0).min(1.0 - first);
    let mut barycentric = [0.0; 3];
    for (corner, weight) in order.into_iter().zip([first, second, (1.0 - first - second).max(0.0)]) {
        barycentric[corner] = weight;
    }

    let position: Point3<f64> = p + along * edge_parameter;
    EdgeFaceIntersection { edge, face, edge_parameter, barycentric, position }
}

fn ratio(part: f64, whole: f64, otherwise: f64) -> f64 {
    if whole > 0.0 && whole.is_finite() { (part / whole).clamp(0.0, 1.0) } else { otherwise }
}
