//! Flags of vertices for the host: inside, near a path.

use crate::{
    analysis::Analysis,
    mesh::{Mesh, VertexId},
    respond::{Corrections, VertexFlags},
};

/// Sets the flags of vertices inside and near a path in corrections that are as after a reset. Near a path is the
/// k-ring, `k = rings`, of the faces that intersect. `front` is scratch.
///
/// Cost: linear in the regions and the flagged vertices.
pub(crate) fn set_flags(
    mesh: &Mesh,
    analysis: &Analysis,
    rings: u32,
    corrections: &mut Corrections,
    front: &mut Vec<VertexId>,
) {
    for &vertex in &analysis.regions.vertices {
        corrections.flag(vertex, VertexFlags::INSIDE);
    }
    front.clear();
    let mut reach = |vertex: VertexId, front: &mut Vec<VertexId>| {
        if !corrections.flags[vertex.index()].contains(VertexFlags::NEAR_PATH) {
            corrections.flag(vertex, VertexFlags::NEAR_PATH);
            front.push(vertex);
        }
    };
    for segment in &analysis.intersections.segments {
        for vertex in segment.faces.into_iter().flat_map(|face| mesh.face(face)) {
            reach(vertex, front);
        }
    }
    let mut first = 0;
    for _ in 0..rings {
        let last = front.len();
        if first == last {
            break;
        }
        for slot in first..last {
            let vertex = front[slot];
            for &edge in mesh.vertex_edges(vertex) {
                reach(mesh.opposite_vertex(edge, vertex), front);
            }
        }
        first = last;
    }
}
