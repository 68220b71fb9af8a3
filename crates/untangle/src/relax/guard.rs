//! Steps that would crush or overstretch the cloth are refused.

use nalgebra::Point3;

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
};

/// No face may lose more than this part of its area in the input.
const SMALLEST_AREA: f64 = 0.06;
/// No edge may get longer than this many times its length in the input, or shorter than the inverse.
const LARGEST_STRETCH: f64 = 1.9;
/// The same where there is no other way.
const LAST_STRETCH: f64 = 3.0;

/// Areas and lengths of the input.
#[derive(Debug)]
pub(super) struct Guard {
    areas: Vec<f64>,
    lengths: Vec<f64>,
}

impl Guard {
    pub(super) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let areas = mesh.face_ids().map(|face| area(mesh, frame.positions(), face)).collect();
        let lengths = mesh.edge_ids().map(|edge| length(mesh, frame.positions(), edge)).collect();
        Self { areas, lengths }
    }

    /// Whether a face or an edge of a vertex has become, or gone on becoming, too small or too long against the input.
    pub(super) fn refuses(&self, mesh: &Mesh, before: &[Point3<f64>], after: &[Point3<f64>], vertex: VertexId) -> bool {
        mesh.vertex_faces(vertex).iter().any(|&face| self.refuses_face(mesh, before, after, face))
            || mesh.vertex_edges(vertex).iter().any(|&edge| self.refuses_edge(mesh, before, after, edge))
    }

    /// Whether a face or an edge of a vertex is too small or too long against the input even for a last resort.
    pub(super) fn is_beyond(&self, mesh: &Mesh, positions: &[Point3<f64>], vertex: VertexId) -> bool {
        let crushed = |&face: &FaceId| area(mesh, positions, face) < SMALLEST_AREA * self.areas[face.index()];
        let strained = |&edge: &EdgeId| self.stretch(mesh, positions, edge).ln().abs() > LAST_STRETCH.ln();
        mesh.vertex_faces(vertex).iter().any(crushed) || mesh.vertex_edges(vertex).iter().any(strained)
    }

    /// Length of an edge over that in the input; 1 where it had none.
    pub(super) fn stretch(&self, mesh: &Mesh, positions: &[Point3<f64>], edge: EdgeId) -> f64 {
        let input = self.lengths[edge.index()];
        if input > 0.0 { length(mesh, positions, edge) / input } else { 1.0 }
    }

    fn refuses_face(&self, mesh: &Mesh, before: &[Point3<f64>], after: &[Point3<f64>], face: FaceId) -> bool {
        let now = area(mesh, after, face);
        now < SMALLEST_AREA * self.areas[face.index()] && now < area(mesh, before, face)
    }

    fn refuses_edge(&self, mesh: &Mesh, before: &[Point3<f64>], after: &[Point3<f64>], edge: EdgeId) -> bool {
        let input = self.lengths[edge.index()];
        let (then, now) = (length(mesh, before, edge), length(mesh, after, edge));
        // An edge without a length may get one.
        let too_long = input > 0.0 && now > LARGEST_STRETCH * input && now > then;
        too_long || (now * LARGEST_STRETCH < input && now < then)
    }
}

fn area(mesh: &Mesh, positions: &[Point3<f64>], face: FaceId) -> f64 {
    let [a, b, c] = mesh.face(face).map(|vertex| positions[vertex.index()]);
    0.5 * (b - a).cross(&(c - a)).norm()
}

fn length(mesh: &Mesh, positions: &[Point3<f64>], edge: EdgeId) -> f64 {
    let [a, b] = mesh.edge(edge).map(|vertex| positions[vertex.index()]);
    (b - a).norm()
}
