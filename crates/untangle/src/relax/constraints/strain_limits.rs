//! Strain limits (Provot 1995): no step may crush or overstretch the cloth.

use nalgebra::Point3;

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    relax::energy::Domain,
};

/// No face may lose more than this part of its area in the input.
const MIN_AREA_RATIO: f64 = 0.06;
/// No edge gets longer than this many times its length in the input, or shorter than the inverse, but by flattening,
/// which is the last resort.
pub const STRETCH_LIMIT: f64 = 1.9;
/// The same for states of the flattening flow, which is the last resort.
const MAX_STRETCH_FLATTENED: f64 = 3.0;

/// Areas and lengths of the input, and the limits of what they may become.
#[derive(Debug)]
pub(crate) struct StrainLimits {
    areas: Vec<f64>,
    lengths: Vec<f64>,
}

impl StrainLimits {
    pub(crate) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let areas = mesh.face_ids().map(|face| area(mesh, frame.positions(), face)).collect();
        let lengths = mesh.edge_ids().map(|edge| length(mesh, frame.positions(), edge)).collect();
        Self { areas, lengths }
    }

    /// Whether a face or an edge of a vertex is beyond its limit after a step, and farther than before it.
    pub(crate) fn is_violated(
        &self,
        mesh: &Mesh,
        before: &[Point3<f64>],
        after: &[Point3<f64>],
        vertex: VertexId,
    ) -> bool {
        mesh.vertex_faces(vertex).iter().any(|&face| self.is_face_violated(mesh, before, after, face))
            || mesh.vertex_edges(vertex).iter().any(|&edge| self.is_edge_violated(mesh, before, after, edge))
    }

    /// The number of vertices of a domain with a face or an edge beyond the limits of the flattening flow.
    pub(crate) fn num_violated(&self, mesh: &Mesh, positions: &[Point3<f64>], domain: &Domain) -> usize {
        let crushed = |&face: &FaceId| area(mesh, positions, face) < MIN_AREA_RATIO * self.areas[face.index()];
        let strained = |&edge: &EdgeId| self.strain(mesh, positions, edge) > libm::log(MAX_STRETCH_FLATTENED);
        let is_violated = |vertex: VertexId| {
            mesh.vertex_faces(vertex).iter().any(crushed) || mesh.vertex_edges(vertex).iter().any(strained)
        };
        domain.vertices().iter().filter(|&&vertex| is_violated(vertex)).count()
    }

    /// The absolute logarithm of an edge's length over that in the input; 0 where it had none.
    pub(crate) fn strain(&self, mesh: &Mesh, positions: &[Point3<f64>], edge: EdgeId) -> f64 {
        let input = self.lengths[edge.index()];
        let stretch = if input > 0.0 { length(mesh, positions, edge) / input } else { 1.0 };
        libm::log(stretch).abs()
    }

    /// The least part of its area in the input that a face has, of those that had one; 1 without any.
    pub(crate) fn least_area(&self, mesh: &Mesh, positions: &[Point3<f64>]) -> f64 {
        let with_area = mesh.face_ids().filter(|face| self.areas[face.index()] > 0.0);
        with_area.map(|face| area(mesh, positions, face) / self.areas[face.index()]).fold(1.0, f64::min)
    }

    fn is_face_violated(&self, mesh: &Mesh, before: &[Point3<f64>], after: &[Point3<f64>], face: FaceId) -> bool {
        let now = area(mesh, after, face);
        now < MIN_AREA_RATIO * self.areas[face.index()] && now < area(mesh, before, face)
    }

    fn is_edge_violated(&self, mesh: &Mesh, before: &[Point3<f64>], after: &[Point3<f64>], edge: EdgeId) -> bool {
        let input = self.lengths[edge.index()];
        let (then, now) = (length(mesh, before, edge), length(mesh, after, edge));
        // An edge without a length may get one.
        let too_long = input > 0.0 && now > STRETCH_LIMIT * input && now > then;
        too_long || (now * STRETCH_LIMIT < input && now < then)
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
