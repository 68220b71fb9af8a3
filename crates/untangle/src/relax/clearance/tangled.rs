//! What is left tangled: distances there mean nothing, and to set primitives apart that have crossed would move them
//! farther to the wrong side.

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, VertexId},
    sides::{Layers, Sides},
    sparse_map::SparseMap,
};

/// Rings round a tangle that stay as they are, too: where it is resolved later, they will move.
const RINGS: usize = 2;

/// Vertices of what intersects, or is on the wrong side of a body or a layer, and those within two rings.
///
/// Cost: a search for intersections, and of sides where there are bodies or layers.
pub(super) fn tangled_vertices(mesh: &Mesh, frame: &Frame) -> SparseMap<VertexId, ()> {
    let mut tangled = SparseMap::default();
    tangled.reset(mesh.num_vertices());
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, frame, &mut found);
    for corner in found.segments.iter().flat_map(|segment| segment.faces).flat_map(|face| mesh.face(face)) {
        tangled.insert(corner, ());
    }
    let bodies = Sides::of(mesh, frame);
    let inside = bodies.as_ref().map(|bodies| bodies.wrong_vertices(mesh, frame)).unwrap_or_default();
    let layers = Layers::of(mesh, frame, bodies.as_ref());
    let behind = layers.map(|layers| layers.behind(mesh, frame.positions())).unwrap_or_default();
    for wrong in inside.iter().chain(&behind) {
        tangled.insert(wrong.vertex, ());
    }
    for corner in behind.iter().flat_map(|wrong| mesh.face(wrong.way.face)) {
        tangled.insert(corner, ());
    }
    let mut first = 0;
    for _ in 0..RINGS {
        let last = tangled.keys().len();
        for index in first..last {
            let vertex = tangled.keys()[index];
            for &edge in mesh.vertex_edges(vertex) {
                tangled.insert(mesh.opposite_vertex(edge, vertex), ());
            }
        }
        first = last;
    }
    tangled
}
