//! The directions along which the two sheets of a contour may be drawn apart.

use nalgebra::Vector3;

use super::contour::Contour;
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    paths::SurfacePoint,
    respond::contour::GUARD,
    sides::Orientation,
};

/// Directions whose cosine is beyond this count as one.
const SAME: f64 = 0.985;

/// Unit directions in which the first sheet may leave the second, the likeliest first, each with its opposite.
pub(super) fn directions(
    mesh: &Mesh,
    frame: &Frame,
    orientation: &Orientation,
    contour: &Contour,
    is_whole: bool,
) -> Vec<Vector3<f64>> {
    let mut found = Vec::new();
    let shortest = 1e-9 * contour.edge_length_m;
    let add_both = |found: &mut Vec<Vector3<f64>>, direction: Vector3<f64>| {
        let Some(unit) = direction.try_normalize(shortest) else { return };
        for unit in [unit, -unit] {
            if found.iter().all(|other| other.dot(&unit) < SAME) {
                found.push(unit);
            }
        }
    };
    add_both(&mut found, descent(mesh, frame, contour));
    let [normals, conormals] = mean_frames(mesh, frame, orientation, contour);
    for sheet in [1, 0] {
        add_both(&mut found, normals[sheet]);
        add_both(&mut found, conormals[sheet]);
    }
    add_both(&mut found, conormals[0] - conormals[1]);
    if !is_whole {
        return found;
    }
    let [a, b, c] = contour.principal_axes();
    for axis in [a, b, c] {
        add_both(&mut found, axis * contour.edge_length_m);
    }
    for (first, second) in [(a, b), (b, c), (c, a)] {
        add_both(&mut found, (first + second) * contour.edge_length_m);
        add_both(&mut found, (first - second) * contour.edge_length_m);
    }
    found
}

/// Minus the gradient of the contour's length where the first sheet is moved and the second is not. At each end of a
/// segment an edge of one sheet pierces a face of the other (Volino and Magnenat-Thalmann 2006).
fn descent(mesh: &Mesh, frame: &Frame, contour: &Contour) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for segment in &contour.segments {
        let Some(tangent) = segment.vector().try_normalize(0.0) else { continue };
        for (end, leaving) in segment.ends.iter().zip([tangent, -tangent]) {
            let (edge, face, own_pierces) = match (end.own, end.partner) {
                (SurfacePoint::Edge { edge, .. }, SurfacePoint::Face { face, .. }) => (edge, face, true),
                (SurfacePoint::Face { face, .. }, SurfacePoint::Edge { edge, .. }) => (edge, face, false),
                _ => continue,
            };
            let [start, end] = mesh.edge(edge).map(|vertex| frame.position(vertex));
            let Some(along) = (end - start).try_normalize(0.0) else { continue };
            let Some(normal) = area(mesh, frame, face).try_normalize(0.0) else { continue };
            let incidence = along.dot(&normal);
            let slide = normal * (along.dot(&leaving) * incidence / (incidence * incidence + GUARD));
            sum += if own_pierces { leaving - slide } else { slide };
        }
    }
    sum * contour.edge_length_m
}

fn area(mesh: &Mesh, frame: &Frame, face: FaceId) -> Vector3<f64> {
    let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
    (b - a).cross(&(c - a))
}

/// For both sheets the mean normal along the contour, and the mean direction to the left of it, in metres: times the
/// contour's length.
fn mean_frames(mesh: &Mesh, frame: &Frame, orientation: &Orientation, contour: &Contour) -> [[Vector3<f64>; 2]; 2] {
    let mut sums = [[Vector3::zeros(); 2]; 2];
    for segment in &contour.segments {
        let tangent = segment.vector();
        for (sheet, face) in segment.faces.into_iter().enumerate() {
            let Some(normal) = orientation.area(mesh, frame, face).try_normalize(0.0) else { continue };
            sums[0][sheet] += normal * tangent.norm();
            sums[1][sheet] += normal.cross(&tangent);
        }
    }
    sums
}
