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
    /// For each row whether it is a separation constraint: a distance between two points along a direction.
    is_separation: Vec<bool>,
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

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        self.ends.clear();
        self.terms.clear();
        self.wanted_m.clear();
        self.is_separation.clear();
    }

    /// Two points that are apart keep a gap, or half of their distance where that is less.
    pub(crate) fn keep_apart(&mut self, frame: &Frame, own: &MaterialPoint, partner: &MaterialPoint, gap_m: f64) {
        let apart = own.position(frame) - partner.position(frame);
        let length = apart.norm();
        if length > 0.0 {
            self.separate(own, partner, apart / length, gap_m.min(0.5 * length) - length);
        }
    }

    /// Takes over the separation constraints of another frame that hold now: these points stay apart from now on. Rows
    /// that shorten a path are left out, since they are no distance.
    pub(crate) fn hold(&mut self, other: &Self, frame: &Frame) {
        for index in 0..other.len() {
            if other.is_separation[index] && other.distance_m(index, frame) > 0.0 {
                self.terms.extend_from_slice(other.row(index));
                self.finish_row(0.0, true);
            }
        }
    }

    /// Sets all rows to keep the distance that there is, but no more than `gap_m`.
    pub(crate) fn limit_to_gap(&mut self, frame: &Frame, gap_m: f64) {
        for index in 0..self.len() {
            let apart = self.distance_m(index, frame);
            self.wanted_m[index] = apart.min(gap_m) - apart;
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
        for (point, sign) in [(own, 1.0), (partner, -1.0)] {
            for (&vertex, weight) in point.vertices.iter().zip(point.weights).filter(|(_, weight)| *weight != 0.0) {
                self.terms.push((vertex, direction * (sign * weight)));
            }
        }
        self.finish_row(wanted_m, true);
    }

    /// A point moves along `direction` by `wanted_m`, more than its partner where that is no fixed point. No later
    /// iteration holds it.
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
        self.finish_row(wanted_m, false);
    }

    fn add_terms(&mut self, point: &MaterialPoint, direction: Vector3<f64>) {
        let weighted = point.vertices.iter().zip(point.weights).filter(|(_, weight)| *weight != 0.0);
        self.terms.extend(weighted.map(|(&vertex, weight)| (vertex, direction * weight)));
    }

    /// Adds a row that is no distance between two points.
    pub(super) fn add(&mut self, terms: impl Iterator<Item = (VertexId, Vector3<f64>)>, wanted_m: f64) {
        self.terms.extend(terms);
        self.finish_row(wanted_m, false);
    }

    /// The left-hand side of a row for positions in place of displacements: the distance of its two points.
    fn distance_m(&self, index: usize, frame: &Frame) -> f64 {
        self.row(index).iter().map(|(vertex, coefficient)| coefficient.dot(&frame.position(*vertex).coords)).sum()
    }

    fn finish_row(&mut self, wanted_m: f64, is_separation: bool) {
        self.is_separation.push(is_separation);
        self.ends.push(self.terms.len());
        self.wanted_m.push(wanted_m);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, MeshDescription};

    #[test]
    fn hold_takes_over_separations_that_hold_and_no_shortening() {
        let faces = vec![[0, 1, 2]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 3, faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let [a, b, c] = [0, 1, 2].map(|vertex| MaterialPoint::vertex(VertexId(vertex)));
        let mut found = Constraints::default();
        found.separate(&b, &a, Vector3::x(), 5.0);
        found.separate(&a, &c, Vector3::y(), 5.0);
        found.add([(VertexId(1), Vector3::x())].into_iter(), 5.0);
        let mut held = Constraints::default();
        held.hold(&found, &frame);
        assert_eq!(held.len(), 1);
        assert_eq!(held.row(0), found.row(0));
        held.limit_to_gap(&frame, 0.5);
        // They are 3 apart, and may come 2.5 nearer.
        assert!((held.wanted_m(0) + 2.5).abs() < 1e-15);
        held.clear();
        held.keep_apart(&frame, &b, &a, 9.0);
        // Half of their distance is less than the gap.
        assert!((held.wanted_m(0) + 1.5).abs() < 1e-15);
    }
}
