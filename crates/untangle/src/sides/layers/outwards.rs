//! What is outwards of a piece of cloth: away from the bodies, out of the tube that it forms, or where its faces point.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    sides::{Orientation, Sides, winding::WindingTree},
};

/// Faces of a piece at which it is asked what is outwards, at most.
const SAMPLES: usize = 256;
/// Votes that sum to less than this part of the area are none: the faces as given are.
const UNDECIDED: f64 = 1e-3;
/// A piece is a flat sheet if its area vectors sum to more than this part of its area: an arc of less than a quarter
/// turn, a cap of less than 37 degrees to each side.
const FLAT: f64 = 0.9;

/// For each face whether its normal points outwards.
pub(super) fn outwards(mesh: &Mesh, frame: &Frame, bodies: Option<&Sides>) -> Vec<bool> {
    let orientation = Orientation::of(mesh);
    let mut pieces: Vec<Vec<FaceId>> = vec![Vec::new(); mesh.num_pieces()];
    for face in mesh.face_ids().filter(|&face| !mesh.is_body_face(face)) {
        if let Some(piece) = mesh.piece(face) {
            pieces[piece.index()].push(face);
        }
    }
    let mut outwards = vec![true; mesh.num_faces()];
    for faces in &pieces {
        let piece = Piece { mesh, frame, orientation: &orientation, faces };
        let is_outwards = piece.is_outwards(bodies);
        for &face in faces {
            outwards[face.index()] = is_outwards != orientation.is_reversed(face);
        }
    }
    outwards
}

/// A piece of cloth, its faces turned so that they agree.
struct Piece<'a> {
    mesh: &'a Mesh,
    frame: &'a Frame,
    orientation: &'a Orientation,
    faces: &'a [FaceId],
}

impl Piece<'_> {
    /// Whether the turned faces point outwards.
    fn is_outwards(&self, bodies: Option<&Sides>) -> bool {
        let (mut sum, mut total, mut as_given) = (Vector3::zeros(), 0.0, 0.0);
        for &face in self.faces {
            let area = self.area(face);
            sum += area;
            total += area.norm();
            as_given += if self.orientation.is_reversed(face) { -area.norm() } else { area.norm() };
        }
        // Most of the area; the lowest face where both are the same.
        let as_given = as_given >= 0.0;
        if bodies.is_none() && sum.norm() > FLAT * total {
            return as_given;
        }
        let votes = self.votes(bodies);
        if votes.abs() < UNDECIDED { as_given } else { votes > 0.0 }
    }

    /// The mean of the votes of some faces, positive where they point outwards: by the way to the bodies, or by how
    /// far the piece winds round its own faces.
    fn votes(&self, bodies: Option<&Sides>) -> f64 {
        let winding = WindingTree::new(&self.faces.iter().map(|&face| self.turned(face)).collect::<Vec<_>>());
        let vote = |&face: &FaceId| {
            let [a, b, c] = self.turned(face);
            let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
            match bodies {
                Some(bodies) => {
                    let is_inside = bodies.is_inside(middle);
                    let way = if is_inside { bodies.way_out(middle) } else { bodies.closest(middle, false) };
                    self.area(face).dot(&way.direction)
                }
                None => self.area(face).norm() * winding.number(middle),
            }
        };
        let step = self.faces.len() / SAMPLES + 1;
        let votes: Vec<f64> = self.faces.par_iter().step_by(step).map(vote).collect();
        let area: f64 = self.faces.iter().step_by(step).map(|&face| self.area(face).norm()).sum();
        if area > 0.0 { votes.iter().sum::<f64>() / area } else { 0.0 }
    }

    fn turned(&self, face: FaceId) -> [Point3<f64>; 3] {
        let [a, b, c] = self.mesh.face(face).map(|vertex| self.frame.position(vertex));
        if self.orientation.is_reversed(face) { [a, c, b] } else { [a, b, c] }
    }

    /// The area vector of a turned face.
    fn area(&self, face: FaceId) -> Vector3<f64> {
        0.5 * self.orientation.area(self.mesh, self.frame, face)
    }
}
