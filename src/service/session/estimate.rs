//! What a session takes, estimated before it is opened.

use untangled_proto::{PayloadLayout, Precision, memory};

/// Memory of the daemon for each vertex and each face: mesh, search tree, frame and corrections. Measured with flat and
/// folded sheets (`tests/daemon/operating/memory.rs`); what intersects comes on top.
const PER_VERTEX: u64 = 600;
const PER_FACE: u64 = 600;
/// Memory of a session however small.
const LEAST: u64 = 1 << 20;

/// Memory of a session in bytes, the daemon's own and shared, while little intersects.
#[must_use]
pub fn memory_bytes(num_vertices: usize, num_faces: usize, precision: Precision, layout: PayloadLayout) -> u64 {
    let own = PER_VERTEX
        .saturating_mul(num_vertices as u64)
        .saturating_add(PER_FACE.saturating_mul(num_faces as u64))
        .saturating_add(LEAST);
    own.saturating_add(memory::session_bytes(num_vertices, precision, layout))
}
