//! The order of faces and of directions round a loop vertex.

use super::SurfacePoint;
use crate::mesh::{EdgeId, FaceId, Mesh, VertexId};

/// Writes the faces round a vertex in order, each with the corner on the edge over which it is entered; false where
/// they are not one fan.
pub(crate) fn ordered_fan(mesh: &Mesh, vertex: VertexId, fan: &mut Vec<(FaceId, VertexId)>) -> bool {
    fan.clear();
    let spokes = mesh.vertex_edges(vertex);
    let Some(first) = spokes.iter().copied().find(|&edge| mesh.is_boundary_edge(edge)).or(spokes.first().copied())
    else {
        return false;
    };
    let mut spoke: EdgeId = first;
    let mut previous = None;
    loop {
        let faces = mesh.edge_faces(spoke);
        if faces.len() > 2 {
            return false;
        }
        let Some(&face) = faces.iter().find(|&&face| Some(face) != previous) else { break };
        fan.push((face, mesh.opposite_vertex(spoke, vertex)));
        let edges = mesh.face_edges(face).unwrap_or_default();
        let Some(&next) = edges.iter().find(|&&edge| edge != spoke && mesh.edge(edge).contains(&vertex)) else {
            return false;
        };
        if next == first {
            break;
        }
        (spoke, previous) = (next, Some(face));
    }
    fan.len() == mesh.vertex_faces(vertex).len()
}

/// A fan whose faces are found by their ids.
pub(crate) struct FanOrder<'a> {
    fan: &'a [(FaceId, VertexId)],
    /// Faces with their places in the fan, sorted.
    ranks: &'a [(FaceId, usize)],
}

impl<'a> FanOrder<'a> {
    /// Sorts the faces of a fan; `ranks` is scratch.
    pub(crate) fn new(fan: &'a [(FaceId, VertexId)], ranks: &'a mut Vec<(FaceId, usize)>) -> Self {
        ranks.clear();
        ranks.extend(fan.iter().enumerate().map(|(rank, &(face, _))| (face, rank)));
        ranks.sort_unstable();
        Self { fan, ranks }
    }

    /// The direction in which a path leaves the vertex: the place of its face in the fan, and where it meets the side
    /// opposite the vertex, from 0 to 1.
    ///
    /// `towards` is the first point of the path after the vertex; it lies in `face`.
    pub(crate) fn direction(
        &self,
        mesh: &Mesh,
        vertex: VertexId,
        face: FaceId,
        towards: SurfacePoint,
    ) -> Option<(usize, f64)> {
        let at = self.ranks.binary_search_by_key(&face, |&(face, _)| face).ok()?;
        let rank = self.ranks[at].1;
        let entered = self.fan[rank].1;
        let left = mesh.face(face).into_iter().find(|&corner| corner != vertex && corner != entered)?;
        let (a, b) = (weight(mesh, towards, entered), weight(mesh, towards, left));
        Some((rank, if a + b > 0.0 { b / (a + b) } else { 0.5 }))
    }
}

/// The barycentric weight of a vertex at a point.
fn weight(mesh: &Mesh, point: SurfacePoint, vertex: VertexId) -> f64 {
    match point {
        SurfacePoint::Vertex(here) => f64::from(u8::from(here == vertex)),
        SurfacePoint::Edge { edge, parameter } => match mesh.edge(edge) {
            [a, _] if a == vertex => 1.0 - parameter,
            [_, b] if b == vertex => parameter,
            _ => 0.0,
        },
        SurfacePoint::Face { face, barycentric } => {
            let corner = mesh.face(face).into_iter().position(|corner| corner == vertex);
            corner.map_or(0.0, |corner| barycentric[corner])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordered_fan_of_boundary_vertex_starts_at_the_boundary() {
        let faces = vec![[0, 1, 2], [0, 3, 4], [3, 0, 2]];
        let description = crate::mesh::MeshDescription { num_vertices: 5, faces, ..Default::default() };
        let mesh = Mesh::new(description).unwrap();
        let mut fan = Vec::new();
        assert!(ordered_fan(&mesh, VertexId(0), &mut fan));
        assert_eq!(fan.iter().map(|(face, _)| face.0).collect::<Vec<_>>(), [0, 2, 1]);
        let towards = SurfacePoint::Face { face: FaceId(2), barycentric: [0.75, 0.0, 0.25] };
        // Entered along 0-2, left along 0-3.
        assert_eq!(
            FanOrder::new(&fan, &mut Vec::new()).direction(&mesh, VertexId(0), FaceId(2), towards),
            Some((1, 0.75))
        );
    }
}
