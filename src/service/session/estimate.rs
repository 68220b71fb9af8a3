//! What a session takes, estimated before it is opened.

use untangled_proto::{PayloadLayout, Precision, SessionOptions, memory};

/// Memory of the daemon for each vertex and each face: mesh, search tree, frame and corrections. A sheet of
/// 99,937 vertices and 198,578 faces takes 69 MB (`tests/daemon/operating/memory.rs`); what intersects comes on top.
const PER_VERTEX: u64 = 300;
const PER_FACE: u64 = 300;
/// Memory of a session however small.
const LEAST: u64 = 1 << 20;

/// Memory of a session in bytes, the daemon's own and shared, while little intersects.
#[must_use]
pub fn memory_bytes(
    num_vertices: usize,
    num_faces: usize,
    precision: Precision,
    layout: PayloadLayout,
    options: SessionOptions,
) -> u64 {
    let own = PER_VERTEX
        .saturating_mul(num_vertices as u64)
        .saturating_add(PER_FACE.saturating_mul(num_faces as u64))
        .saturating_add(LEAST);
    own.saturating_add(memory::session_bytes(num_vertices, precision, layout, options))
}
