//! Which faces of a patch lie beside each other, found once for all that goes from face to face.

use super::numbering::{Numbering, narrow};
use crate::mesh::{FaceId, Mesh};

/// Marks what has no face or side.
const ABSENT: u32 = u32::MAX;

/// The sides that faces of a patch have in common.
#[derive(Debug, Default)]
pub(super) struct CommonSides {
    /// For each side of each face the face beyond it and its side there.
    beyond: Vec<[(u32, u8); 3]>,
    /// Scratch: for each vertex the last of the sides whose lower end it is, and for each side the one before it and
    /// its higher end.
    last_sides: Vec<u32>,
    sides_before: Vec<(u32, u32)>,
}

impl CommonSides {
    /// The face beyond a side of another one, and its side there.
    #[inline]
    pub(super) fn beyond(&self, face: usize, side: usize) -> Option<(usize, usize)> {
        let (next, there) = self.beyond[face][side];
        (next != ABSENT).then_some((next as usize, usize::from(there)))
    }

    fn clear(&mut self, num_faces: usize) {
        self.beyond.clear();
        self.beyond.resize(num_faces, [(ABSENT, 0); 3]);
    }

    /// Joins faces with two common vertices: where no edge has more than two faces, nothing of the mesh is needed.
    pub(super) fn join_common(&mut self, corners: &[[u32; 3]], num_vertices: usize) {
        self.clear(corners.len());
        self.last_sides.clear();
        self.last_sides.resize(num_vertices, ABSENT);
        self.sides_before.clear();
        for (face, corners) in corners.iter().enumerate() {
            for side in 0..3 {
                let [a, b] = ends_of(corners, side);
                let (low, high) = (a.min(b), a.max(b));
                let mut slot = self.last_sides[low as usize];
                while slot != ABSENT && self.sides_before[slot as usize].1 != high {
                    slot = self.sides_before[slot as usize].0;
                }
                if slot == ABSENT {
                    let last = &mut self.last_sides[low as usize];
                    self.sides_before.push((std::mem::replace(last, narrow(3 * face + side)), high));
                } else {
                    self.sides_before.push((ABSENT, ABSENT));
                    self.join([slot as usize / 3, face], [slot as usize % 3, side]);
                }
            }
        }
    }

    /// Joins the faces of edges that have two faces.
    pub(super) fn join_along_edges(&mut self, mesh: &Mesh, faces: &Numbering<FaceId>, corners: &[[u32; 3]]) {
        self.clear(corners.len());
        for (face, &id) in faces.keys().iter().enumerate() {
            let Some(edges) = mesh.face_edges(id) else { continue };
            for (side, edge) in edges.into_iter().enumerate() {
                // Each pair of neighbours is found from the first of the two.
                if self.beyond[face][side].0 != ABSENT {
                    continue;
                }
                let &[one, other] = mesh.edge_faces(edge) else { continue };
                let Some(next) = faces.get(if one == id { other } else { one }) else { continue };
                let [a, b] = ends_of(&corners[face], side);
                let is_common = |&there: &usize| [[a, b], [b, a]].contains(&ends_of(&corners[next as usize], there));
                if let Some(there) = (0..3).find(is_common) {
                    self.join([face, next as usize], [side, there]);
                }
            }
        }
    }

    /// Makes two faces neighbours across one side of each.
    fn join(&mut self, faces: [usize; 2], sides: [usize; 2]) {
        for (k, other) in [(0, 1), (1, 0)] {
            #[expect(clippy::cast_possible_truncation, reason = "one of three")]
            let there = sides[other] as u8;
            self.beyond[faces[k]][sides[k]] = (narrow(faces[other]), there);
        }
    }
}

/// The ends of a side of a face.
pub(super) fn ends_of(corners: &[u32; 3], side: usize) -> [u32; 2] {
    [corners[side], corners[(side + 1) % 3]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::{sheet, tube};

    #[test]
    fn faces_joined_by_common_vertices_are_those_joined_along_edges() {
        for mesh in [sheet(7, 5, 0.1).0, tube(12, 5)] {
            let mut faces = Numbering::default();
            let mut corners = Vec::new();
            for face in mesh.face_ids() {
                faces.number(face);
                corners.push(mesh.face(face).map(|vertex| vertex.0));
            }
            let [mut common, mut along] = [CommonSides::default(), CommonSides::default()];
            common.join_common(&corners, mesh.num_vertices());
            along.join_along_edges(&mesh, &faces, &corners);
            assert_eq!(common.beyond, along.beyond);
            let num_outer = common.beyond.as_flattened().iter().filter(|(next, _)| *next == ABSENT).count();
            assert_eq!(num_outer, mesh.num_boundary_edges());
        }
    }
}
