//! As-rigid-as-possible energy (ARAP; Sorkine and Alexa 2007) over a domain, with one rotation per vertex.
//!
//! Energy of a displacement `d` of the vertices: `1/2 sum |d_i|^2 + s/2 sum_ij w_ij |(y_i - y_j) - R_ij e_ij|^2` with
//! `y = x + d`. Edges `e` are those of the present shape, mixed with those of the rest shape; `R_ij` is the mean of the
//! rotations that fit the edges round `i` and `j` best. With the rotations held the energy is quadratic and the same
//! for the three coordinates. The stiffness `s` is dimensionless: its root is the length, in edges, over which a
//! displacement decays.

use nalgebra::{Matrix3, Point3, Vector3};

use super::{domain::Domain, rotation::turn_into_nearest_rotations};
use crate::{
    frame::Frame,
    mesh::{EdgeId, Mesh, VertexId},
};

/// Weights of edges are cotangents (Pinkall and Polthier 1993), limited to this and its inverse.
const MIN_WEIGHT: f64 = 0.2;

/// The positions of the input, which are the rest shape, and the weights of all edges of its mesh.
#[derive(Debug)]
pub(crate) struct RestShape {
    weights: Vec<f64>,
    positions: Vec<Point3<f64>>,
}

impl RestShape {
    pub(crate) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let mut weights = vec![0.0; mesh.num_edges()];
        for face in mesh.face_ids() {
            let Some(edges) = mesh.face_edges(face) else { continue };
            let corners = mesh.face(face).map(|vertex| frame.position(vertex));
            for (k, edge) in edges.into_iter().enumerate() {
                let (a, b) = (corners[k] - corners[(k + 2) % 3], corners[(k + 1) % 3] - corners[(k + 2) % 3]);
                let cotangent = a.dot(&b) / a.cross(&b).norm();
                weights[edge.index()] += 0.5 * if cotangent.is_finite() { cotangent } else { 0.0 };
            }
        }
        for weight in &mut weights {
            *weight = weight.clamp(MIN_WEIGHT, 1.0 / MIN_WEIGHT);
        }
        Self { weights, positions: frame.positions().to_vec() }
    }

    pub(super) fn weight(&self, edge: EdgeId) -> f64 {
        self.weights[edge.index()]
    }

    /// The rest position of a vertex, in metres.
    pub(crate) fn position(&self, vertex: VertexId) -> Point3<f64> {
        self.positions[vertex.index()]
    }

    /// The positions of the input in metres, one for each vertex.
    pub(crate) fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    fn edge_vector(&self, from: VertexId, to: VertexId) -> Vector3<f64> {
        self.positions[to.index()] - self.positions[from.index()]
    }
}

/// The energy of displacements from one frame.
#[derive(Clone, Copy)]
pub(crate) struct ArapEnergy<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) rest: &'a RestShape,
    pub(crate) domain: &'a Domain,
    /// The part of the rest shape in the edges that are kept: 0 keeps the present shape, 1 restores the rest shape.
    pub(crate) rest_weight: f64,
    /// The part of the weight of an edge that keeps its length at rest only; the other part keeps its direction as
    /// well, and so resists bending and shear.
    pub(crate) membrane: f64,
    /// The part of the way back to the input that the displacement is measured from: 0 for the present positions, 1 for
    /// those of the input.
    pub(crate) anchor: f64,
}

impl ArapEnergy<'_> {
    /// Length of an edge after a displacement over its rest length.
    pub(crate) fn stretch(&self, displacement: &[Vector3<f64>], edge: EdgeId) -> f64 {
        let [a, b] = self.mesh.edge(edge);
        let moved = |vertex: VertexId| self.frame.position(vertex) + self.displacement_of(displacement, vertex);
        (moved(b) - moved(a)).norm() / self.rest.edge_vector(a, b).norm()
    }

    /// The elastic force at zero displacement, with the rotations that fit `displacement`: the right-hand side of the
    /// system. `stiffening` has one factor for each edge of the mesh.
    pub(crate) fn force(
        &self,
        stiffness: f64,
        displacement: &[Vector3<f64>],
        stiffening: &[f64],
        rotations: &mut Vec<[Matrix3<f64>; 2]>,
        out: &mut [Vector3<f64>],
    ) {
        let Self { mesh, frame, rest, domain, rest_weight, membrane, anchor } = *self;
        self.find_rotations(displacement, rotations);
        for (local, &vertex) in domain.vertices().iter().enumerate() {
            let mut force = (rest.position(vertex) - frame.position(vertex)) * anchor;
            for &edge in mesh.vertex_edges(vertex) {
                let other = mesh.opposite_vertex(edge, vertex);
                let there = rotations[domain.local(other).unwrap_or(local)];
                let now = frame.position(other) - frame.position(vertex);
                let wanted = (rotations[local][0] + there[0]) * now * (0.5 * (1.0 - rest_weight))
                    + (rotations[local][1] + there[1]) * rest.edge_vector(vertex, other) * (0.5 * rest_weight);
                let wanted = if membrane > 0.0 {
                    let then =
                        now + self.displacement_of(displacement, other) - self.displacement_of(displacement, vertex);
                    let length = rest.edge_vector(vertex, other).norm();
                    wanted * (1.0 - membrane) + with_length(then, length) * membrane
                } else {
                    wanted
                };
                // The force on `vertex` towards the place where the edge to `other` has the wanted shape.
                force += (now - wanted) * (stiffness * rest.weight(edge) * stiffening[edge.index()]);
            }
            out[local] = force;
        }
    }

    /// The energy of the domain in other positions, one for each vertex of the mesh, with the rotations that fit these
    /// best: of the rest shape, without what the step itself costs.
    pub(crate) fn value(&self, stiffness: f64, positions: &[Point3<f64>]) -> f64 {
        let Self { mesh, rest, domain, membrane, anchor, .. } = *self;
        let mut rotations: Vec<Matrix3<f64>> = Vec::with_capacity(domain.vertices().len());
        rotations.extend(domain.vertices().iter().map(|&vertex| self.turn_from_rest(positions, vertex)));
        turn_into_nearest_rotations(rotations.iter_mut());
        let mut sum = 0.0;
        for (local, &vertex) in domain.vertices().iter().enumerate() {
            sum += anchor * (positions[vertex.index()] - rest.position(vertex)).norm_squared();
            for &edge in mesh.vertex_edges(vertex) {
                let other = mesh.opposite_vertex(edge, vertex);
                // Each edge within the domain once.
                let part = if domain.local(other).is_some() { 0.5 } else { 1.0 };
                let there = rotations[domain.local(other).unwrap_or(local)];
                let input = rest.edge_vector(vertex, other);
                let now = positions[other.index()] - positions[vertex.index()];
                let shape = (now - (rotations[local] + there) * input * 0.5).norm_squared();
                let length = now.norm() - input.norm();
                let both = (1.0 - membrane) * shape + membrane * length * length;
                sum += part * stiffness * rest.weight(edge) * both;
            }
        }
        0.5 * sum
    }

    /// The matrix whose nearest rotation takes the rest edges round a vertex to those of other positions.
    fn turn_from_rest(&self, positions: &[Point3<f64>], vertex: VertexId) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for &edge in self.mesh.vertex_edges(vertex) {
            let other = self.mesh.opposite_vertex(edge, vertex);
            let now = positions[other.index()] - positions[vertex.index()];
            sum += now * self.rest.edge_vector(vertex, other).transpose() * self.rest.weight(edge);
        }
        sum
    }

    /// The rotations that take the present edges and the rest edges round each vertex to the displaced ones; one
    /// without weight in the force is not computed.
    fn find_rotations(&self, displacement: &[Vector3<f64>], rotations: &mut Vec<[Matrix3<f64>; 2]>) {
        rotations.clear();
        rotations.extend(self.domain.vertices().iter().map(|&vertex| self.turns(displacement, vertex)));
        for (k, weight) in [1.0 - self.rest_weight, self.rest_weight].into_iter().enumerate() {
            if weight > 0.0 {
                turn_into_nearest_rotations(rotations.iter_mut().map(|both| &mut both[k]));
            }
        }
    }

    /// The matrices whose nearest rotations those of a vertex are.
    fn turns(&self, displacement: &[Vector3<f64>], vertex: VertexId) -> [Matrix3<f64>; 2] {
        let mut sums = [Matrix3::zeros(); 2];
        for &edge in self.mesh.vertex_edges(vertex) {
            let other = self.mesh.opposite_vertex(edge, vertex);
            let now = self.frame.position(other) - self.frame.position(vertex);
            let then = now + self.displacement_of(displacement, other) - self.displacement_of(displacement, vertex);
            sums[0] += then * now.transpose() * self.rest.weight(edge);
            sums[1] += then * self.rest.edge_vector(vertex, other).transpose() * self.rest.weight(edge);
        }
        sums
    }

    fn displacement_of(&self, displacement: &[Vector3<f64>], vertex: VertexId) -> Vector3<f64> {
        self.domain.local(vertex).map_or_else(Vector3::zeros, |local| displacement[local])
    }
}

/// A vector with another length; one without a length stays as it is.
fn with_length(vector: Vector3<f64>, length: f64) -> Vector3<f64> {
    let own = vector.norm();
    if own > 0.0 { vector * (length / own) } else { vector }
}
