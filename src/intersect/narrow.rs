//! Edge-face tests with exact signs.

use super::Intersections;
use crate::{frame::Frame, mesh::Mesh};

/// Finds all intersections of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Intersector {}

impl Intersector {
    /// Finds all intersections of `frame`.
    pub fn intersect(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        let _ = (mesh, frame);
        found.edge_face.clear();
        found.segments.clear();
    }
}
