//! How the cloth turned round its vertices, from a pose of reference to a frame.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
    relax::nearest_rotation,
};

/// The directions of the material at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Turns<'a> {
    mesh: &'a Mesh,
    reference: &'a [[f64; 3]],
    frame: &'a Frame,
}

impl<'a> Turns<'a> {
    /// Of a frame beside a pose of reference, `num_vertices x 3`. The pose says nothing of the frame's corrections: it
    /// may be any in which the neighbours of a vertex are not all in one line.
    #[must_use]
    pub fn new(mesh: &'a Mesh, reference: &'a [[f64; 3]], frame: &'a Frame) -> Self {
        Self { mesh, reference, frame }
    }

    /// The rotation that takes the edges of a vertex in the pose of reference nearest to those of the frame.
    #[must_use]
    pub fn at(&self, vertex: VertexId) -> Matrix3<f64> {
        let reference = |vertex: VertexId| Point3::from(self.reference[vertex.index()]);
        let mut sum = Matrix3::zeros();
        for &edge in self.mesh.vertex_edges(vertex) {
            let other = self.mesh.opposite_vertex(edge, vertex);
            let now = self.frame.position(other) - self.frame.position(vertex);
            sum += now * (reference(other) - reference(vertex)).transpose();
        }
        // A vertex without edges, or all in one place, does not turn.
        if sum.norm() > 0.0 { nearest_rotation(&sum) } else { Matrix3::identity() }
    }

    /// A vector of the frame in the directions of the material.
    #[must_use]
    pub fn to_material(&self, vertex: VertexId, vector: Vector3<f64>) -> Vector3<f64> {
        self.at(vertex).transpose() * vector
    }

    /// A vector in the directions of the material as one of the frame.
    #[must_use]
    pub fn to_frame(&self, vertex: VertexId, vector: Vector3<f64>) -> Vector3<f64> {
        self.at(vertex) * vector
    }
}
