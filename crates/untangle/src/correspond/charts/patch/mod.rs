//! A part of the cloth round a path, with vertex numbers of its own.

mod numbering;
mod sides;

use self::{
    numbering::{Numbering, narrow},
    sides::{CommonSides, ends_of},
};
use crate::mesh::{FaceId, Mesh, VertexId};

/// Marks slots of the cut that have no vertex yet.
const ABSENT: u32 = u32::MAX;

/// Faces round a path and their vertices, numbered in the order in which they were found.
///
/// Cost: a patch costs its faces, not those of the mesh.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    faces: Numbering<FaceId>,
    corners: Vec<[u32; 3]>,
    /// The vertices, and behind them the copies that a cut makes.
    vertices: Vec<VertexId>,
    num_seeds: usize,
    sides: CommonSides,
    vertex_numbers: Numbering<VertexId>,
    /// Vertices before a cut doubled some of them, and for each added one the vertex it is a copy of.
    num_whole: usize,
    copied_from: Vec<u32>,
    /// Scratch of [`cut`](Self::cut): a union-find forest over the corners of all faces, one tree for each sector of
    /// faces round a vertex that the cut leaves connected; for each root its vertex; whether a vertex already went to a
    /// sector.
    sectors: Vec<u32>,
    vertex_of_sector: Vec<u32>,
    is_taken: Vec<bool>,
}

/// The neighbour of a face across one of its sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    /// Its number in the patch.
    pub(super) face: usize,
    /// Its own side there.
    pub(super) side: usize,
    /// Whether both name the vertices of their common side in the same direction: neighbours of one winding don't.
    pub(super) is_same_way: bool,
}

impl Patch {
    /// Replaces the patch by the faces of a path, in the order of the path, each once: the seeds.
    pub(crate) fn start(&mut self, mesh: &Mesh, path_faces: impl Iterator<Item = FaceId>) {
        self.faces.clear();
        self.vertex_numbers.clear();
        self.vertices.clear();
        self.corners.clear();
        self.add_faces(mesh, path_faces);
        self.num_seeds = self.faces().len();
    }

    /// Adds faces.
    pub(crate) fn add_faces(&mut self, mesh: &Mesh, faces: impl Iterator<Item = FaceId>) {
        for face in faces {
            self.add_face(mesh, face);
        }
    }

    /// Adds the stars of `vertices`: every face that has one of them as a corner.
    pub(crate) fn add_stars(&mut self, mesh: &Mesh, vertices: &[VertexId]) {
        for &vertex in vertices {
            for &face in mesh.vertex_faces(vertex) {
                self.add_face(mesh, face);
            }
        }
    }

    /// Adds the `rings`-ring of the patch, but stops once there are `max_faces`.
    pub(crate) fn grow(&mut self, mesh: &Mesh, rings: usize, max_faces: usize) {
        let mut first = 0;
        for _ in 0..rings {
            let last = self.vertices.len();
            if first == last {
                // The end of the mesh: callers may ask for more rings than there are.
                return;
            }
            for slot in first..last {
                if self.faces().len() >= max_faces {
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
        if !self.faces.number(face).1 {
            return;
        }
        let corners = mesh.face(face).map(|vertex| {
            let (number, is_new) = self.vertex_numbers.number(vertex);
            if is_new {
                self.vertices.push(vertex);
            }
            number
        });
        self.corners.push(corners);
    }

    /// Finds the neighbours of all faces, once the patch holds all of them.
    ///
    /// Cost: linear in the faces.
    pub(super) fn connect(&mut self, mesh: &Mesh) {
        if mesh.is_manifold() {
            self.sides.join_common(&self.corners, self.vertices.len());
        } else {
            self.sides.join_along_edges(mesh, &self.faces, &self.corners);
        }
    }

    /// The neighbour across a side of a face. Nothing on the outline of the patch, beyond a non-manifold edge and
    /// across a cut.
    pub(super) fn neighbour(&self, face: usize, side: usize) -> Option<Neighbour> {
        let (next, there) = self.sides.beyond(face, side)?;
        let ends = ends_of(&self.corners[face], side);
        let [c, d] = ends_of(&self.corners[next], there);
        let is_same_way = ends == [c, d];
        (is_same_way || ends == [d, c]).then_some(Neighbour { face: next, side: there, is_same_way })
    }

    /// Cuts the patch along sides of its faces: a vertex on the cut gets a copy for each further sector of faces round
    /// it that the cut leaves connected.
    pub(super) fn cut(&mut self, sides: &[[bool; 3]]) {
        self.join_sectors(sides);
        self.num_whole = self.vertices.len();
        self.copied_from.clear();
        self.vertex_of_sector.clear();
        self.vertex_of_sector.resize(3 * self.corners.len(), ABSENT);
        self.is_taken.clear();
        self.is_taken.resize(self.vertices.len(), false);
        for slot in 0..3 * self.corners.len() {
            let root = root(&mut self.sectors, slot);
            let vertex = &mut self.corners[slot / 3][slot % 3];
            if self.vertex_of_sector[root] == ABSENT {
                self.vertex_of_sector[root] = *vertex;
                if std::mem::replace(&mut self.is_taken[*vertex as usize], true) {
                    self.vertex_of_sector[root] = narrow(self.vertices.len());
                    self.copied_from.push(*vertex);
                    self.vertices.push(self.vertices[*vertex as usize]);
                }
            }
            *vertex = self.vertex_of_sector[root];
        }
    }

    /// Unites the corners that neighbouring faces have in a vertex of their common side, but for sides of the cut.
    fn join_sectors(&mut self, sides: &[[bool; 3]]) {
        self.sectors.clear();
        self.sectors.extend((0..).take(3 * self.corners.len()));
        for (face, cut) in sides.iter().enumerate() {
            for side in (0..3).filter(|&side| !cut[side]) {
                let neighbour = self.neighbour(face, side).filter(|neighbour| neighbour.face > face);
                let Some(Neighbour { face: next, side: there, .. }) = neighbour else { continue };
                for corner in [side, (side + 1) % 3] {
                    let vertex = self.corners[face][corner];
                    let other = if self.corners[next][there] == vertex { there } else { (there + 1) % 3 };
                    let a = root(&mut self.sectors, 3 * face + corner);
                    let b = root(&mut self.sectors, 3 * next + other);
                    self.sectors[a.max(b)] = narrow(a.min(b));
                }
            }
        }
    }

    /// Undoes the last [`cut`](Self::cut).
    pub(super) fn undo_cut(&mut self) {
        for vertex in self.corners.iter_mut().flatten() {
            if *vertex as usize >= self.num_whole {
                *vertex = self.copied_from[*vertex as usize - self.num_whole];
            }
        }
        self.vertices.truncate(self.num_whole);
    }

    /// The faces; those of the path come first.
    pub(crate) fn faces(&self) -> &[FaceId] {
        self.faces.keys()
    }

    /// How many of the faces the path runs through.
    pub(super) fn num_seeds(&self) -> usize {
        self.num_seeds
    }

    /// For each face its vertices in the numbers of the patch.
    pub(super) fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The vertices; copies made by a cut come last.
    pub(super) fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// The number of a face here, if it belongs to the patch.
    pub(super) fn local_face(&self, face: FaceId) -> Option<usize> {
        self.faces.get(face).map(|number| number as usize)
    }

    /// The number of a vertex here, if it belongs to the patch.
    pub(super) fn local_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.vertex_numbers.get(vertex).map(|number| number as usize)
    }
}

/// The first corner of the sector that a corner belongs to. Halves the path to it (Tarjan and van Leeuwen 1984).
fn root(sectors: &mut [u32], mut slot: usize) -> usize {
    while sectors[slot] as usize != slot {
        sectors[slot] = sectors[sectors[slot] as usize];
        slot = sectors[slot] as usize;
    }
    slot
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    #[test]
    fn patch_grown_by_one_ring_holds_the_stars_of_its_seed() {
        let (mesh, _) = sheet(8, 8, 0.1);
        let mut patch = Patch::default();
        patch.start(&mesh, [FaceId(60)].into_iter());
        assert_eq!((patch.faces().len(), patch.vertices().len(), patch.num_seeds()), (1, 3, 1));
        patch.grow(&mesh, 1, usize::MAX);
        assert_eq!(patch.faces().len(), 13);
        assert_eq!(patch.local_vertex(mesh.face(FaceId(0))[0]), None);
    }

    #[test]
    fn patch_started_again_holds_its_new_seeds_only() {
        let (mesh, _) = sheet(8, 8, 0.1);
        let mut patch = Patch::default();
        patch.start(&mesh, [FaceId(60)].into_iter());
        patch.start(&mesh, [FaceId(0)].into_iter());
        assert_eq!(patch.local_face(FaceId(60)), None);
        assert_eq!(patch.local_vertex(mesh.face(FaceId(0))[0]), Some(0));
    }

    #[test]
    fn patch_grown_beyond_a_limit_or_the_mesh_stops_there() {
        let (mesh, _) = sheet(8, 8, 0.1);
        let mut patch = Patch::default();
        patch.start(&mesh, [FaceId(0)].into_iter());
        patch.grow(&mesh, 100, 20);
        assert!(patch.faces().len() >= 20 && patch.faces().len() < 128);
        // More rings than there are must cost no more than those there are.
        patch.grow(&mesh, usize::MAX, usize::MAX);
        assert_eq!(patch.faces().len(), 128);
    }
}
