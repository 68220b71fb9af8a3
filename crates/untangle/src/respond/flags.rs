//! Flags of vertices for the host: inside, near a path, pinned.

use crate::{
    analysis::Analysis,
    mesh::{Mesh, VertexId},
    respond::VertexFlags,
};

/// Sets the flags of all vertices; `flags` holds one, unset, for each. Near a path is the k-ring, `k = rings`, of the
/// faces that intersect. `front` is scratch.
///
/// Cost: linear in the regions and the flagged vertices, and one pass over all vertices where some are pinned.
pub(crate) fn set_flags(
    mesh: &Mesh,
    analysis: &Analysis,
    rings: u32,
    flags: &mut [VertexFlags],
    front: &mut Vec<VertexId>,
) {
    for vertex in mesh.vertex_ids().filter(|&vertex| mesh.is_pinned(vertex)) {
        flags[vertex.index()].insert(VertexFlags::PINNED);
    }
    for &vertex in &analysis.regions.vertices {
        flags[vertex.index()].insert(VertexFlags::INSIDE);
    }
    front.clear();
    let mut reach = |vertex: VertexId, front: &mut Vec<VertexId>| {
        let flags = &mut flags[vertex.index()];
        if !flags.contains(VertexFlags::NEAR_PATH) {
            flags.insert(VertexFlags::NEAR_PATH);
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
