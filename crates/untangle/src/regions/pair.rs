//! What the two paths of a pair say about each other's insides.

use nalgebra::Vector3;

use super::{InsideRegions, side::Scene};
use crate::{
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{PathSegment, SurfacePoint},
};

/// The detour from an inner end to the hem is at most this part of a path's faces.
const LONGEST_DETOUR: usize = 8;
/// No more faces than this are looked at round an inner end.
const MOST_FACES: usize = 200;

/// Finds whether paths run from hem to hem, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct Shore {
    /// For each of both paths the edges of the detours from its ends to the boundary.
    detours: [Vec<EdgeId>; 2],
    /// Faces reached, from which one and across which edge.
    faces: Vec<(FaceId, usize, Option<EdgeId>)>,
}

impl Shore {
    /// Whether each of two corresponding paths of one piece joins two different boundaries of it, from end to end or with a short
    /// detour at its ends. Such a path never separates.
    ///
    /// Cost: the length of a boundary.
    pub(crate) fn reach(&mut self, scene: &Scene<'_>, copies: [usize; 2]) -> bool {
        self.detours.iter_mut().for_each(Vec::clear);
        let faces = copies.map(|copy| scene.paths.segments[scene.paths.copies[copy].segments.start].own);
        if scene.mesh.piece(faces[0]) != scene.mesh.piece(faces[1]) {
            return false;
        }
        (0..2).all(|index| {
            let copy = &scene.paths.copies[copies[index]];
            let points = &scene.paths.points[copy.points.clone()];
            let longest = (copy.segments.len() / LONGEST_DETOUR).max(1);
            let mut hem = |place: Option<&SurfacePoint>| self.hem(scene.mesh, *place?, longest, index);
            let (start, end) =
                (hem(points.first().map(|point| &point.own)), hem(points.last().map(|point| &point.own)));
            start.zip(end).is_some_and(|(start, end)| !on_one_boundary(scene.mesh, start, end))
        })
    }

    /// The edges of the detours of the first or second path.
    pub(crate) fn edges(&self, index: usize) -> impl Iterator<Item = EdgeId> + '_ {
        self.detours[index].iter().copied()
    }

    /// The boundary edge at an end of a path, or the nearest one over at most `longest` faces.
    fn hem(&mut self, mesh: &Mesh, place: SurfacePoint, longest: usize, index: usize) -> Option<EdgeId> {
        let face = match place {
            SurfacePoint::Edge { edge, .. } => return mesh.is_boundary_edge(edge).then_some(edge),
            SurfacePoint::Vertex(_) => return None,
            SurfacePoint::Face { face, .. } => face,
        };
        self.faces.clear();
        self.faces.push((face, 0, None));
        let (mut next, mut ring_end, mut ring) = (0, 1, 0);
        while next < self.faces.len() && self.faces.len() < MOST_FACES {
            if next == ring_end {
                (ring, ring_end) = (ring + 1, self.faces.len());
            }
            if ring >= longest {
                return None;
            }
            let here = self.faces[next].0;
            for edge in mesh.face_edges(here)? {
                if mesh.is_boundary_edge(edge) {
                    self.detours[index].push(edge);
                    let mut at = next;
                    while let (_, before, Some(crossed)) = self.faces[at] {
                        self.detours[index].push(crossed);
                        at = before;
                    }
                    return Some(edge);
                }
                for &face in mesh.edge_faces(edge) {
                    if self.faces.iter().all(|&(known, ..)| known != face) {
                        self.faces.push((face, next, Some(edge)));
                    }
                }
            }
            next += 1;
        }
        None
    }
}

/// Whether a way along the boundary leads from one of its edges to another.
fn on_one_boundary(mesh: &Mesh, start: EdgeId, end: EdgeId) -> bool {
    let (mut edge, [_, mut vertex]) = (start, mesh.edge(start));
    for _ in 0..=mesh.num_boundary_edges() {
        if edge == end {
            return true;
        }
        let next = mesh.vertex_edges(vertex).iter().find(|&&other| other != edge && mesh.is_boundary_edge(other));
        let Some(&next) = next.filter(|&&next| next != start) else { return false };
        (edge, vertex) = (next, mesh.opposite_vertex(next, vertex));
    }
    // Boundaries that touch in a vertex: no telling.
    true
}

/// Mean over the length of a pair of paths of the product of the unit directions that point, at right angles to the path, into both
/// insides: 1 where the sheets lie upon each other with the insides on the same side, -1 where on opposite sides, 0 where they cross at a
/// right angle or where one of them has no inside.
pub(crate) fn agreement(scene: &Scene<'_>, copy: usize, regions: &InsideRegions) -> f64 {
    let path = &scene.paths.copies[copy];
    let insides = [copy, path.partner].map(|copy| regions.vertices_of(copy));
    if insides.iter().any(|inside| inside.is_empty()) {
        return 0.0;
    }
    let points = &scene.paths.points[path.points.clone()];
    let segments = &scene.paths.segments[path.segments.clone()];
    let (mut sum, mut length) = (0.0, 0.0);
    for (pair, &PathSegment { own, partner }) in points.windows(2).zip(segments) {
        let step = pair[1].position - pair[0].position;
        let middle = nalgebra::center(&pair[0].position, &pair[1].position);
        length += step.norm();
        let inwards = |face: FaceId, inside: &[VertexId]| {
            let [a, b, c] = scene.mesh.face(face).map(|corner| scene.frame.position(corner));
            let across = (b - a).cross(&(c - a)).cross(&step).try_normalize(0.0)?;
            let mut side = 0.0;
            for corner in scene.mesh.face(face) {
                let reach = (scene.frame.position(corner) - middle).dot(&across);
                side += if inside.binary_search(&corner).is_ok() { reach } else { -reach };
            }
            Some::<Vector3<f64>>(if side < 0.0 { -across } else { across })
        };
        if let (Some(one), Some(other)) = (inwards(own, insides[0]), inwards(partner, insides[1])) {
            sum += step.norm() * one.dot(&other);
        }
    }
    if length > 0.0 { sum / length } else { 0.0 }
}
