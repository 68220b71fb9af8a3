//! Detours from the ends of a path to the boundary: they tell whether a pair of paths joins two boundaries of a tube.

use super::view::FrameView;
use crate::{
    mesh::{EdgeId, FaceId, Mesh},
    paths::SurfacePoint,
};

/// A detour from an inner end to the boundary crosses at most this part of the number of the path's faces.
const LONGEST_DETOUR: usize = 8;
/// The search round an inner end stops after this many faces.
const MOST_FACES: usize = 200;

/// Searches for detours to the boundary, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct BoundaryDetours {
    /// For each of both paths the edges that the detours from its ends to the boundary cross.
    crossed: [Vec<EdgeId>; 2],
    /// Faces in the order of the search, each with the place of the face before it and the edge between them.
    searched: Vec<(FaceId, usize, Option<EdgeId>)>,
}

impl BoundaryDetours {
    /// Whether each of two corresponding paths of one piece joins two different boundaries of it, from end to end or
    /// with a short detour at its ends. Such a path never separates its piece alone.
    ///
    /// Cost: the length of a boundary.
    pub(crate) fn join_two_boundaries(&mut self, view: &FrameView<'_>, copies: [usize; 2]) -> bool {
        self.crossed.iter_mut().for_each(Vec::clear);
        let faces = copies.map(|copy| view.paths.segments[view.paths.copies[copy].segments.start].own);
        if view.mesh.piece(faces[0]) != view.mesh.piece(faces[1]) {
            return false;
        }
        (0..2).all(|index| {
            let copy = &view.paths.copies[copies[index]];
            let points = view.points_of(copy);
            let longest = (copy.segments.len() / LONGEST_DETOUR).max(1);
            let mut boundary_edge =
                |place: Option<&SurfacePoint>| self.nearest_boundary_edge(view.mesh, *place?, longest, index);
            let start = boundary_edge(points.first().map(|point| &point.own));
            let end = boundary_edge(points.last().map(|point| &point.own));
            start.zip(end).is_some_and(|(start, end)| !are_on_one_boundary(view.mesh, start, end))
        })
    }

    /// The edges that the detours of the first or the second path cross.
    pub(crate) fn edges(&self, index: usize) -> impl Iterator<Item = EdgeId> + '_ {
        self.crossed[index].iter().copied()
    }

    /// The boundary edge at an end of a path, or the nearest one by a breadth-first search over at most `longest`
    /// faces.
    fn nearest_boundary_edge(
        &mut self,
        mesh: &Mesh,
        place: SurfacePoint,
        longest: usize,
        index: usize,
    ) -> Option<EdgeId> {
        let face = match place {
            SurfacePoint::Edge { edge, .. } => return mesh.is_boundary_edge(edge).then_some(edge),
            SurfacePoint::Vertex(_) => return None,
            SurfacePoint::Face { face, .. } => face,
        };
        self.searched.clear();
        self.searched.push((face, 0, None));
        let (mut next, mut ring_end, mut ring) = (0, 1, 0);
        while next < self.searched.len() && self.searched.len() < MOST_FACES {
            if next == ring_end {
                (ring, ring_end) = (ring + 1, self.searched.len());
            }
            if ring >= longest {
                return None;
            }
            for edge in mesh.face_edges(self.searched[next].0)? {
                if mesh.is_boundary_edge(edge) {
                    self.keep_detour(edge, next, index);
                    return Some(edge);
                }
                for &face in mesh.edge_faces(edge) {
                    if self.searched.iter().all(|&(known, ..)| known != face) {
                        self.searched.push((face, next, Some(edge)));
                    }
                }
            }
            next += 1;
        }
        None
    }

    /// Notes the boundary edge and the edges crossed on the way to the face at a place of the search.
    fn keep_detour(&mut self, boundary_edge: EdgeId, place: usize, index: usize) {
        self.crossed[index].push(boundary_edge);
        let mut at = place;
        while let (_, before, Some(crossed)) = self.searched[at] {
            self.crossed[index].push(crossed);
            at = before;
        }
    }
}

/// Whether a walk along the boundary leads from one of its edges to another.
fn are_on_one_boundary(mesh: &Mesh, start: EdgeId, end: EdgeId) -> bool {
    let (mut edge, [_, mut vertex]) = (start, mesh.edge(start));
    for _ in 0..=mesh.num_boundary_edges() {
        if edge == end {
            return true;
        }
        let next = mesh.vertex_edges(vertex).iter().find(|&&other| other != edge && mesh.is_boundary_edge(other));
        let Some(&next) = next.filter(|&&next| next != start) else { return false };
        (edge, vertex) = (next, mesh.opposite_vertex(next, vertex));
    }
    // Boundaries that share a vertex: the walk may have changed from one to the other, so no answer is certain.
    true
}
