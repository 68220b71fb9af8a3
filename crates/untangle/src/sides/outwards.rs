//! Faces of bodies, turned so that they point outwards.

use nalgebra::Point3;

use super::Numbered;
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// The faces of all bodies, and whether all of their pieces are closed.
#[derive(Debug)]
pub(super) struct Outwards {
    pub(super) faces: Vec<Numbered>,
    pub(super) triangles: Vec<[Point3<f64>; 3]>,
    pub(super) are_closed: bool,
}

impl Outwards {
    /// Turns the closed pieces round whose volume is negative.
    ///
    /// Cost: linear in the mesh.
    pub(super) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let closed = mesh.closed_pieces();
        let place = |face: FaceId| mesh.face(face).map(|vertex| frame.position(vertex));
        let usable = || {
            let faces = mesh.face_ids().filter(|&face| mesh.is_body_face(face));
            faces.filter_map(|face| mesh.piece(face).map(|piece| (face, piece.index())))
        };
        // Volumes by the first corner of each piece, since places far from the origin would lose digits.
        let mut volumes: Vec<(Option<Point3<f64>>, f64)> = vec![(None, 0.0); mesh.num_pieces()];
        for (face, piece) in usable() {
            let [a, b, c] = place(face);
            let (origin, volume) = &mut volumes[piece];
            let origin = *origin.get_or_insert(a);
            *volume += (a - origin).dot(&(b - origin).cross(&(c - origin)));
        }
        let mut found = Self { faces: Vec::new(), triangles: Vec::new(), are_closed: true };
        for (face, piece) in usable() {
            let is_turned = closed[piece] && volumes[piece].1 < 0.0;
            let [a, b, c] = place(face);
            found.faces.push(Numbered { face, is_turned });
            found.triangles.push(if is_turned { [a, c, b] } else { [a, b, c] });
            found.are_closed &= closed[piece];
        }
        found
    }
}
