//! A part of the cloth round a path, with vertex numbers of its own.

use crate::mesh::{FaceId, Mesh, VertexId};

const ABSENT: u32 = u32::MAX;

/// Faces round a path and their vertices, numbered in the order in which they were found.
///
/// The tables over the whole mesh are made once and wiped by undoing, so that the cost of a patch is that of its faces.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    faces: Vec<FaceId>,
    corners: Vec<[u32; 3]>,
    vertices: Vec<VertexId>,
    num_seeds: usize,
    face_index: Vec<u32>,
    vertex_index: Vec<u32>,
    /// Vertices before a cut doubled some of them, and for each added one the vertex it is a copy of.
    num_whole: usize,
    copied_from: Vec<u32>,
    sectors: Vec<u32>,
    names: Vec<u32>,
    is_taken: Vec<bool>,
}

/// A face beside another one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beyond {
    pub(crate) face: usize,
    /// Its own side there.
    pub(crate) side: usize,
    /// Whether both name the vertices of their common side in the same direction: neighbours of one winding don't.
    pub(crate) is_same_way: bool,
}

impl Patch {
    /// Begins anew with the faces of a path, in the order of the path, each once.
    pub(crate) fn start(&mut self, mesh: &Mesh, path_faces: impl Iterator<Item = FaceId>) {
        for face in self.faces.drain(..) {
            self.face_index[face.index()] = ABSENT;
        }
        for vertex in self.vertices.drain(..) {
            self.vertex_index[vertex.index()] = ABSENT;
        }
        self.corners.clear();
        self.face_index.resize(mesh.num_faces(), ABSENT);
        self.vertex_index.resize(mesh.num_vertices(), ABSENT);
        self.add_faces(mesh, path_faces);
        self.num_seeds = self.faces.len();
    }

    /// Adds faces.
    pub(crate) fn add_faces(&mut self, mesh: &Mesh, faces: impl Iterator<Item = FaceId>) {
        for face in faces {
            self.add_face(mesh, face);
        }
    }

    /// Adds every face that touches one of `vertices`.
    pub(crate) fn add_around(&mut self, mesh: &Mesh, vertices: &[VertexId]) {
        for &vertex in vertices {
            for &face in mesh.vertex_faces(vertex) {
                self.add_face(mesh, face);
            }
        }
    }

    /// Adds `rings` rings of faces, but stops once there are `max_faces`.
    pub(crate) fn grow(&mut self, mesh: &Mesh, rings: usize, max_faces: usize) {
        let mut first = 0;
        for _ in 0..rings {
            let last = self.vertices.len();
            if first == last {
                // The end of the mesh: what asks for rings may ask for more than there are.
                return;
            }
            for slot in first..last {
                if self.faces.len() >= max_faces {
                    return;
                }
                for &face in mesh.vertex_faces(self.vertices[slot]) {
                    self.add_face(mesh, face);
                }
            }
            first = last;
        }
    }

    fn add_face(&mut self, mesh: &Mesh, face: FaceId) {
        if self.face_index[face.index()] != ABSENT {
            return;
        }
        self.face_index[face.index()] = small(self.faces.len());
        self.faces.push(face);
        let corners = mesh.face(face).map(|vertex| {
            let slot = &mut self.vertex_index[vertex.index()];
            if *slot == ABSENT {
                *slot = small(self.vertices.len());
                self.vertices.push(vertex);
            }
            *slot
        });
        self.corners.push(corners);
    }

    /// What lies beyond a side of a face. Nothing on the outline of the patch, beyond a non-manifold edge and across a cut.
    pub(crate) fn beyond(&self, mesh: &Mesh, face: usize, side: usize) -> Option<Beyond> {
        let edge = mesh.face_edges(self.faces[face])?[side];
        let &[one, other] = mesh.edge_faces(edge) else { return None };
        let next = self.local_face(if one == self.faces[face] { other } else { one })?;
        let here = &self.corners[face];
        let (a, b) = (here[side], here[(side + 1) % 3]);
        let there = &self.corners[next];
        for side in 0..3 {
            let (c, d) = (there[side], there[(side + 1) % 3]);
            if (a, b) == (d, c) || (a, b) == (c, d) {
                return Some(Beyond { face: next, side, is_same_way: a == c });
            }
        }
        None
    }

    /// Cuts the patch along sides of its faces: vertices on the cut get a copy for each sector of faces that is left round them.
    pub(crate) fn cut(&mut self, mesh: &Mesh, sides: &[[bool; 3]]) {
        self.num_whole = self.vertices.len();
        self.copied_from.clear();
        self.sectors.clear();
        self.sectors.extend((0..).take(3 * self.faces.len()));
        for (face, cut) in sides.iter().enumerate() {
            for side in (0..3).filter(|&side| !cut[side]) {
                let beyond = self.beyond(mesh, face, side).filter(|beyond| beyond.face > face);
                let Some(Beyond { face: next, side: there, .. }) = beyond else { continue };
                for corner in [side, (side + 1) % 3] {
                    let vertex = self.corners[face][corner];
                    let other = if self.corners[next][there] == vertex { there } else { (there + 1) % 3 };
                    let (a, b) =
                        (root(&mut self.sectors, 3 * face + corner), root(&mut self.sectors, 3 * next + other));
                    self.sectors[a.max(b)] = small(a.min(b));
                }
            }
        }
        self.names.clear();
        self.names.resize(3 * self.faces.len(), ABSENT);
        self.is_taken.clear();
        self.is_taken.resize(self.vertices.len(), false);
        for slot in 0..3 * self.faces.len() {
            let root = root(&mut self.sectors, slot);
            let vertex = &mut self.corners[slot / 3][slot % 3];
            if self.names[root] == ABSENT {
                self.names[root] = *vertex;
                if std::mem::replace(&mut self.is_taken[*vertex as usize], true) {
                    self.names[root] = small(self.vertices.len());
                    self.copied_from.push(*vertex);
                    self.vertices.push(self.vertices[*vertex as usize]);
                }
            }
            *vertex = self.names[root];
        }
    }

    /// Undoes the last [`cut`](Self::cut).
    pub(crate) fn join(&mut self) {
        for vertex in self.corners.iter_mut().flatten() {
            if *vertex as usize >= self.num_whole {
                *vertex = self.copied_from[*vertex as usize - self.num_whole];
            }
        }
        self.vertices.truncate(self.num_whole);
    }

    /// The faces; those of the path come first.
    pub(crate) fn faces(&self) -> &[FaceId] {
        &self.faces
    }

    /// How many of the faces the path runs through.
    pub(crate) fn num_seeds(&self) -> usize {
        self.num_seeds
    }

    /// For each face its vertices in the numbers of the patch.
    pub(crate) fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The vertices; copies made by a cut come last.
    pub(crate) fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// The number of a face here, if it belongs to the patch.
    pub(crate) fn local_face(&self, face: FaceId) -> Option<usize> {
        self.face_index.get(face.index()).filter(|&&index| index != ABSENT).map(|&index| index as usize)
    }

    /// The number of a vertex here, if it belongs to the patch.
    pub(crate) fn local_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.vertex_index.get(vertex.index()).filter(|&&index| index != ABSENT).map(|&index| index as usize)
    }
}

/// The first slot of the sector that a slot belongs to.
fn root(sectors: &mut [u32], mut slot: usize) -> usize {
    while sectors[slot] as usize != slot {
        sectors[slot] = sectors[sectors[slot] as usize];
        slot = sectors[slot] as usize;
    }
    slot
}

fn small(index: usize) -> u32 {
    u32::try_from(index).expect("a patch has no more elements than its mesh, whose indices fit 31 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    #[test]
    fn rings_grow_from_the_path_and_a_new_start_forgets() {
        let (mesh, _) = sheet(8, 8, 0.1);
        let mut patch = Patch::default();
        patch.start(&mesh, [FaceId(60)].into_iter());
        assert_eq!((patch.faces().len(), patch.vertices().len(), patch.num_seeds()), (1, 3, 1));
        patch.grow(&mesh, 1, usize::MAX);
        assert_eq!(patch.faces().len(), 13);
        let far = mesh.face(FaceId(0))[0];
        assert_eq!(patch.local_vertex(far), None);
        patch.start(&mesh, [FaceId(0)].into_iter());
        assert_eq!(patch.local_face(FaceId(60)), None);
        assert_eq!(patch.local_vertex(far), Some(0));
        patch.grow(&mesh, 100, 20);
        assert!(patch.faces().len() >= 20 && patch.faces().len() < 128);
        // As many rings as there can't be, which must take no longer.
        patch.grow(&mesh, usize::MAX, usize::MAX);
        assert_eq!(patch.faces().len(), 128);
    }
}
