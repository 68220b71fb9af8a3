//! As-rigid-as-possible energy of single triangles (Liu et al. 2008), each with its rest shape in the plane.
//!
//! Energy of a triangle: `sum_k w_k |e_k - R q_k|^2`, where `q` are its rest edges in its own plane, `R` is the
//! 3 x 2 matrix with orthonormal columns that fits them best to the present edges `e`, and `w` are cotangents (Pinkall
//! and Polthier 1993).

use nalgebra::{Matrix3x2, Point3, Vector2, Vector3};

use super::rotation::nearest_orthonormal;
use crate::mesh::VertexId;

/// Cotangents are limited to this and its inverse.
const MIN_WEIGHT: f64 = 0.2;
/// A triangle is strained where an edge changes its length by more than this factor, and crushed where it keeps less
/// than this part of its area (thin triangles may lose their area with edges that hardly change).
const MAX_STRETCH: f64 = 1.5;
const MIN_AREA_RATIO: f64 = 0.5;

/// A triangle with the vector of each edge in the plane of its rest shape and the weight of that edge. Edge k is
/// opposite to corner k.
#[derive(Debug)]
pub(super) struct RestTriangle {
    pub(super) corners: [VertexId; 3],
    edges: [Vector2<f64>; 3],
    pub(super) weights: [f64; 3],
    /// Factor by which the weights are larger than the cotangents.
    pub(super) stiffening: f64,
}

impl RestTriangle {
    pub(super) fn of(corners: [VertexId; 3], at: [Point3<f64>; 3]) -> Self {
        let flat = flat_corners(at);
        let weights = [0, 1, 2].map(|k| {
            let (a, b) = (flat[(k + 1) % 3] - flat[k], flat[(k + 2) % 3] - flat[k]);
            let cotangent = a.dot(&b) / a.perp(&b).abs();
            if cotangent.is_nan() { 1.0 } else { cotangent.clamp(MIN_WEIGHT, 1.0 / MIN_WEIGHT) }
        });
        Self { corners, edges: [0, 1, 2].map(|k| flat[(k + 2) % 3] - flat[(k + 1) % 3]), weights, stiffening: 1.0 }
    }

    /// Multiplies the weights.
    pub(super) fn stiffen(&mut self, factor: f64) {
        self.stiffening *= factor;
        for weight in &mut self.weights {
            *weight *= factor;
        }
    }

    /// The logarithms of its edges' lengths over their rest lengths; without edges for which that is not finite.
    pub(super) fn strains<'a>(&'a self, positions: &'a [Point3<f64>]) -> impl Iterator<Item = f64> + 'a {
        let strains = self.edges.iter().enumerate().map(|(k, edge)| {
            let [a, b] = [1, 2].map(|step| positions[self.corners[(k + step) % 3].index()]);
            libm::log((b - a).norm() / edge.norm())
        });
        strains.filter(|strain| strain.is_finite())
    }

    /// Whether an edge is too long or too short, or the area too small.
    pub(super) fn is_strained(&self, positions: &[Point3<f64>]) -> bool {
        self.strains(positions).any(|strain| strain.abs() > libm::log(MAX_STRETCH)) || self.is_crushed(positions)
    }

    fn is_crushed(&self, positions: &[Point3<f64>]) -> bool {
        let [a, b, c] = self.corners.map(|vertex| positions[vertex.index()]);
        0.5 * (b - a).cross(&(c - a)).norm() < MIN_AREA_RATIO * self.rest_area()
    }

    /// Its area at rest, in square metres.
    pub(super) fn rest_area(&self) -> f64 {
        0.5 * self.edges[0].perp(&self.edges[1]).abs()
    }

    /// What each corner adds to the right-hand side of the global step: the rest edges, rotated to fit the present
    /// ones.
    pub(super) fn corner_forces(&self, positions: &[Point3<f64>]) -> [Vector3<f64>; 3] {
        let at = self.corners.map(|vertex| positions[vertex.index()]);
        let mut sum = Matrix3x2::zeros();
        for k in 0..3 {
            sum += (at[(k + 2) % 3] - at[(k + 1) % 3]) * self.edges[k].transpose() * self.weights[k];
        }
        let fit = nearest_orthonormal(&sum);
        let mut forces = [Vector3::zeros(); 3];
        for k in 0..3 {
            let edge = fit * self.edges[k] * self.weights[k];
            forces[(k + 2) % 3] += edge;
            forces[(k + 1) % 3] -= edge;
        }
        forces
    }
}

/// The corners of a triangle in its own plane: the first at the origin, the second on the first axis.
fn flat_corners(at: [Point3<f64>; 3]) -> [Vector2<f64>; 3] {
    let (along, other) = (at[1] - at[0], at[2] - at[0]);
    let length = along.norm();
    let across = if length > 0.0 { along.dot(&other) / length } else { 0.0 };
    let height = (other.norm_squared() - across * across).max(0.0).sqrt();
    [Vector2::zeros(), Vector2::new(length, 0.0), Vector2::new(across, height)]
}
