//! Intersections among pinned vertices only. No motion changes them, so that nothing is judged by them.

use crate::{
    intersect::{EdgeFaceIntersection, Intersections, Segment, SegmentEnd},
    mesh::{FaceId, Mesh, VertexId},
};

fn all_pinned(mesh: &Mesh, mut vertices: impl Iterator<Item = VertexId>) -> bool {
    vertices.all(|vertex| mesh.is_pinned(vertex))
}

/// Whether all corners of some faces are pinned.
pub(crate) fn are_faces_pinned(mesh: &Mesh, faces: impl IntoIterator<Item = FaceId>) -> bool {
    all_pinned(mesh, faces.into_iter().flat_map(|face| mesh.face(face)))
}

/// Whether a motion can change an intersection: one of its edge's ends or its face's corners is free.
pub(crate) fn is_movable(mesh: &Mesh, found: &EdgeFaceIntersection) -> bool {
    !all_pinned(mesh, mesh.edge(found.edge).into_iter().chain(mesh.face(found.face)))
}

/// The number of edge-face intersections that a motion can change.
pub(crate) fn num_movable(mesh: &Mesh, found: &Intersections) -> usize {
    found.edge_face.iter().filter(|found| is_movable(mesh, found)).count()
}

/// Removes the chains of segments whose faces have pinned corners only. Gives back whether there were any. A chain with
/// one free corner stays whole, since tracing needs all of its segments.
///
/// Cost: linear in the segments.
pub(crate) fn remove_pinned_chains(mesh: &Mesh, found: &mut Intersections) -> bool {
    let is_pinned = |segment: &Segment| are_faces_pinned(mesh, segment.faces);
    if !found.segments.iter().any(is_pinned) {
        return false;
    }
    let mut chains = Chains { parents: (0..found.edge_face.len()).collect() };
    for segment in &found.segments {
        if let [SegmentEnd::EdgeFace(a), SegmentEnd::EdgeFace(b)] = segment.ends {
            chains.join(a as usize, b as usize);
        }
    }
    let mut is_free = vec![false; found.edge_face.len()];
    for segment in found.segments.iter().filter(|segment| !is_pinned(segment)) {
        for root in chains.of(segment) {
            is_free[root] = true;
        }
    }
    found.segments.retain(|segment| chains.of(segment).any(|root| is_free[root]));
    let (mut numbers, mut next) = (vec![0; found.edge_face.len()], 0);
    let mut index = 0;
    found.edge_face.retain(|_| {
        let stays = is_free[chains.root(index)];
        numbers[index] = next;
        next += u32::from(stays);
        index += 1;
        stays
    });
    for end in found.segments.iter_mut().flat_map(|segment| &mut segment.ends) {
        if let SegmentEnd::EdgeFace(index) = end {
            *index = numbers[*index as usize];
        }
    }
    found.edge_face.len() < numbers.len()
}

/// Disjoint sets of edge-face intersections that segments join: the parent of each, or itself.
struct Chains {
    parents: Vec<usize>,
}

impl Chains {
    fn root(&self, mut index: usize) -> usize {
        while self.parents[index] != index {
            index = self.parents[index];
        }
        index
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|index| {
            let root = self.root(index);
            self.parents[index] = root;
            root
        });
        self.parents[a.max(b)] = a.min(b);
    }

    /// The chain of a segment, once for each of its ends that is no loop vertex.
    fn of(&self, segment: &Segment) -> impl Iterator<Item = usize> {
        segment.ends.into_iter().filter_map(|end| match end {
            SegmentEnd::EdgeFace(index) => Some(self.root(index as usize)),
            SegmentEnd::LoopVertex(_) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{frame::Frame, intersect::Intersector, mesh::MeshDescription};

    /// Triangles in a row that each pierce one large triangle, with so many of their corners pinned from the first on.
    fn found(num_pinned: u32) -> (Mesh, Intersections) {
        let mut positions = vec![[-9.0, -9.0, 0.0], [30.0, -9.0, 0.0], [-9.0, 30.0, 0.0]];
        let mut faces = vec![[0, 1, 2]];
        for place in [0.0, 1.0] {
            let first = u32::try_from(positions.len()).unwrap();
            positions.extend([[place, 0.0, -1.0], [place, 0.2, 1.0], [place, 0.6, 1.0]]);
            faces.push([first, first + 1, first + 2]);
        }
        let pins = (0..num_pinned).collect();
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, pins, ..Default::default() });
        let mesh = mesh.unwrap();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut found = Intersections::default();
        Intersector::default().intersect(&mesh, &frame, &mut found);
        (mesh, found)
    }

    #[test]
    fn remove_pinned_chains_leaves_those_with_a_free_corner() {
        for (num_pinned, segments, movable) in [(0, 2, 4), (3, 2, 4), (5, 2, 3), (6, 1, 2), (8, 1, 1), (9, 0, 0)] {
            let (mesh, mut found) = found(num_pinned);
            assert_eq!((found.segments.len(), found.edge_face.len()), (2, 4));
            assert_eq!(num_movable(&mesh, &found), movable, "{num_pinned}");
            assert_eq!(remove_pinned_chains(&mesh, &mut found), segments < 2);
            assert_eq!((found.segments.len(), found.edge_face.len()), (segments, 2 * segments), "{num_pinned}");
            for segment in &found.segments {
                for end in segment.ends {
                    let SegmentEnd::EdgeFace(index) = end else { panic!("no vertex is shared") };
                    let edge = found.edge_face[index as usize].edge;
                    let face = segment.faces.into_iter().find(|&face| face.index() > 0).unwrap();
                    assert!(mesh.edge(edge).iter().all(|vertex| mesh.face(face).contains(vertex)));
                }
            }
        }
    }
}
