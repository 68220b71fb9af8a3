//! Linear inequalities on the displacements of vertices.

use nalgebra::Vector3;

use crate::{correspond::MaterialPoint, frame::Frame, mesh::VertexId};

/// `sum of coefficient . displacement >= wanted_m`, one row for each constraint. Where coefficients are unit vectors
/// times weights, both sides are in metres.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    /// Where the terms of each row end.
    ends: Vec<usize>,
    terms: Vec<(VertexId, Vector3<f64>)>,
    wanted_m: Vec<f64>,
}

impl Constraints {
    pub(crate) fn len(&self) -> usize {
        self.wanted_m.len()
    }

    pub(crate) fn row(&self, index: usize) -> &[(VertexId, Vector3<f64>)] {
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.terms[start..self.ends[index]]
    }

    pub(crate) fn wanted_m(&self, index: usize) -> f64 {
        self.wanted_m[index]
    }

    /// All vertices with a term, some of them several times.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.terms.iter().map(|&(vertex, _)| vertex)
    }

    /// Vertices of rows that are not satisfied where nothing moves, some of them several times.
    pub(crate) fn violated_vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        let violated = (0..self.len()).filter(|&index| self.wanted_m[index] > 0.0);
        violated.flat_map(|index| self.row(index)).map(|&(vertex, _)| vertex)
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        self.ends.clear();
        self.terms.clear();
        self.wanted_m.clear();
    }

    /// Two points that are apart keep a gap, or half of their distance where that is less.
    pub(crate) fn keep_apart(&mut self, frame: &Frame, own: &MaterialPoint, partner: &MaterialPoint, gap_m: f64) {
        let apart = own.position(frame) - partner.position(frame);
        let length = apart.norm();
        if length > 0.0 {
            self.separate(own, partner, apart / length, gap_m.min(0.5 * length) - length);
        }
    }

    /// `own` moves along `direction` by `wanted_m` more than `partner`.
    pub(crate) fn separate(
        &mut self,
        own: &MaterialPoint,
        partner: &MaterialPoint,
        direction: Vector3<f64>,
        wanted_m: f64,
    ) {
        self.push(own, Some(partner), direction, wanted_m);
    }

    /// A point moves along `direction` by `wanted_m`, more than its partner where that is no fixed point.
    pub(crate) fn push(
        &mut self,
        own: &MaterialPoint,
        partner: Option<&MaterialPoint>,
        direction: Vector3<f64>,
        wanted_m: f64,
    ) {
        self.add_terms(own, direction);
        if let Some(partner) = partner {
            self.add_terms(partner, -direction);
        }
        self.finish_row(wanted_m);
    }

    fn add_terms(&mut self, point: &MaterialPoint, direction: Vector3<f64>) {
        let weighted = point.vertices.iter().zip(point.weights).filter(|(_, weight)| *weight != 0.0);
        self.terms.extend(weighted.map(|(&vertex, weight)| (vertex, direction * weight)));
    }

    /// Adds a row that is no distance between two points.
    pub(super) fn add(&mut self, terms: impl Iterator<Item = (VertexId, Vector3<f64>)>, wanted_m: f64) {
        self.terms.extend(terms);
        self.finish_row(wanted_m);
    }

    fn finish_row(&mut self, wanted_m: f64) {
        self.ends.push(self.terms.len());
        self.wanted_m.push(wanted_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, MeshDescription};

    #[test]
    fn keep_apart_keeps_a_gap_or_half_of_a_smaller_distance() {
        let faces = vec![[0, 1, 2]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 3, faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let [a, b] = [0, 1].map(|vertex| MaterialPoint::vertex(VertexId(vertex)));
        for (gap_m, wanted_m) in [(0.5, -2.5), (9.0, -1.5)] {
            let mut rows = Constraints::default();
            rows.keep_apart(&frame, &b, &a, gap_m);
            assert_eq!(rows.len(), 1);
            assert_eq!(rows.row(0), [(VertexId(1), Vector3::x()), (VertexId(0), -Vector3::x())]);
            assert!((rows.wanted_m(0) - wanted_m).abs() < 1e-15);
        }
    }
}
