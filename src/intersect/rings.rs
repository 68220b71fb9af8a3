//! The vertices round each vertex, in turn: known from the topology, listed once.

use crate::mesh::{FaceId, Mesh, VertexId};

/// Rings of all vertices whose faces could meet beyond them.
#[derive(Debug, Default)]
pub(crate) struct Rings {
    centres: Vec<VertexId>,
    offsets: Vec<u32>,
    around: Vec<VertexId>,
}

/// The neighbourhood of one vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring<'a> {
    pub(crate) centre: VertexId,
    /// Its neighbours in turn, one face between each two; a ring that closes ends in its first vertex again. Empty where the faces do not form
    /// one simple fan.
    pub(crate) around: &'a [VertexId],
}

impl Rings {
    /// Rings of the corners of `faces`, in the order in which these first have them. Cost: linear in the faces, but quadratic round one
    /// vertex.
    pub(crate) fn new(mesh: &Mesh, faces: &[FaceId]) -> Self {
        let mut rings = Self { offsets: vec![0], ..Self::default() };
        let mut is_listed = vec![false; mesh.num_vertices()];
        let mut rest = Vec::new();
        for &face in faces {
            for centre in mesh.face(face) {
                if std::mem::replace(&mut is_listed[centre.index()], true) {
                    continue;
                }
                let first = rings.around.len();
                let is_simple = rings.walk(mesh, centre, &mut rest);
                let ring = &rings.around[first..];
                let closes = is_simple && ring.first() == ring.last();
                // Faces of so few that each shares an edge with each other one can't meet.
                let are_all_joined = is_simple && ring.len() - 1 <= if closes { 3 } else { 2 };
                if are_all_joined || !is_simple {
                    rings.around.truncate(first);
                }
                if !are_all_joined {
                    rings.centres.push(centre);
                    let end = u32::try_from(rings.around.len()).expect("two for each corner of a face at most");
                    rings.offsets.push(end);
                }
            }
        }
        rings
    }

    /// Appends the ring; false if the faces do not form one simple fan.
    fn walk(&mut self, mesh: &Mesh, centre: VertexId, rest: &mut Vec<[VertexId; 2]>) -> bool {
        let faces = mesh.vertex_faces(centre);
        if faces.len() > super::neighbours::MOST_FACES {
            return false;
        }
        rest.clear();
        rest.extend(faces.iter().map(|&face| {
            let corners = mesh.face(face);
            let at = corners.iter().position(|&corner| corner == centre).unwrap_or_default();
            [corners[(at + 1) % 3], corners[(at + 2) % 3]]
        }));
        let is_end =
            |vertex: VertexId, sides: &[[VertexId; 2]]| sides.iter().filter(|side| side.contains(&vertex)).count() == 1;
        let start = rest.iter().flatten().copied().find(|&vertex| is_end(vertex, rest)).unwrap_or(rest[0][0]);
        let first = self.around.len();
        self.around.push(start);
        let mut last = start;
        while let Some(next) = rest.iter().position(|side| side.contains(&last)) {
            let [a, b] = rest.swap_remove(next);
            last = if a == last { b } else { a };
            if self.around[first + 1..].contains(&last) || (last == start && !rest.is_empty()) {
                return false;
            }
            self.around.push(last);
        }
        rest.is_empty()
    }

    /// Number of rings.
    pub(crate) fn len(&self) -> usize {
        self.centres.len()
    }

    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> Ring<'_> {
        let around = &self.around[self.offsets[index] as usize..self.offsets[index + 1] as usize];
        Ring { centre: self.centres[index], around }
    }
}
