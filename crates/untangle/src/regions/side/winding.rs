//! Winding numbers of solids.

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// The winding number of the solid pieces of a frame about the centroid of one of their faces, as the mean of its
/// values on both sides of the face: 1/2 for a face that separates the outside from the inside of one solid, if the
/// piece of the face is oriented outwards, or inwards as a whole.
///
/// Nothing if the face does not belong to a solid. Source: solid angles by van Oosterom and Strackee (1983). Cost:
/// linear in the faces.
pub(crate) fn winding_number(mesh: &Mesh, frame: &Frame, face: FaceId) -> Option<f64> {
    let piece = mesh.piece(face).filter(|&piece| mesh.is_solid(piece))?;
    let corners = |face: FaceId| mesh.face(face).map(|vertex| frame.position(vertex).coords);
    let [a, b, c] = corners(face);
    let middle = (a + b + c) / 3.0;
    let mut solid_angle = 0.0;
    let mut volume = 0.0;
    for other in mesh.face_ids() {
        let Some(other_piece) = mesh.piece(other).filter(|&piece| mesh.is_solid(piece)) else { continue };
        let [a, b, c] = corners(other).map(|corner| corner - middle);
        let triple = a.dot(&b.cross(&c));
        if other_piece == piece {
            volume += triple;
        }
        if other != face {
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            solid_angle += 2.0 * libm::atan2(triple, denominator);
        }
    }
    // Pieces that are oriented inwards as a whole have the opposite winding number.
    Some(volume.signum() * solid_angle / (4.0 * std::f64::consts::PI))
}
