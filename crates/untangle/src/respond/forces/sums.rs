//! Sums of forces: opposite pairs, each spread over the vertices of the face in which it acts.

use nalgebra::{Point3, Vector3};

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{Mesh, VertexId},
    respond::{Corrections, VertexFlags},
    sparse_map::SparseMap,
};

/// The sum of a vertex is limited to this many times the largest correction of one path.
const LARGEST_SUM: f64 = 3.0;

/// Sums of forces by vertex, with what is needed to limit them.
#[derive(Debug, Default)]
pub(crate) struct Forces {
    sums: SparseMap<VertexId, VertexForce>,
}

#[derive(Clone, Copy, Debug, Default)]
struct VertexForce {
    /// In kg m / step^2.
    sum: Vector3<f64>,
    /// The largest displacement of one step that some path allows the vertex.
    limit_m: f64,
}

impl Forces {
    /// Clears all forces.
    pub(crate) fn reset(&mut self, num_vertices: usize) {
        self.sums.reset(num_vertices);
    }

    /// Adds a force on one vertex.
    pub(crate) fn add(&mut self, vertex: VertexId, force: Vector3<f64>, limit_m: f64) {
        let total = self.sums.entry(vertex);
        total.limit_m = total.limit_m.max(limit_m.max(f64::MIN_POSITIVE));
        total.sum += force;
    }

    /// Adds a force at a point and its opposite at another. With both in one place, or the force along the line between
    /// them, neither the sum of all forces nor that of all torques changes.
    pub(crate) fn add_pair(&mut self, at: &MaterialPoint, against: &MaterialPoint, force: Vector3<f64>, limit_m: f64) {
        for (point, sign) in [(at, 1.0), (against, -1.0)] {
            for (&vertex, weight) in point.vertices.iter().zip(point.weights) {
                if weight != 0.0 {
                    self.add(vertex, force * (sign * weight), limit_m);
                }
            }
        }
    }

    /// Writes sums, residuals and limits into corrections whose forces are zero.
    pub(crate) fn finish(&mut self, mesh: &Mesh, frame: &Frame, corrections: &mut Corrections) {
        // Sorted, so that the sums below don't depend on the order of the paths.
        self.sums.sort_keys();
        let total = |vertex: VertexId| self.sums.get(vertex).unwrap_or_default();
        let vertices = self.sums.keys();
        let mut centre = Vector3::zeros();
        for &vertex in vertices {
            corrections.net_force += total(vertex).sum;
            centre += frame.position(vertex).coords;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let centre = Point3::from(centre / vertices.len().max(1) as f64);
        for &vertex in vertices {
            let VertexForce { sum: mut force, limit_m } = total(vertex);
            corrections.net_torque += (frame.position(vertex) - centre).cross(&force);
            if mesh.is_pinned(vertex) {
                continue;
            }
            let mass = mass_kg(mesh, vertex);
            let largest = LARGEST_SUM * limit_m * mass;
            let size = force.norm();
            if size > largest {
                force *= largest / size;
                corrections.flag(vertex, VertexFlags::CLAMPED);
            }
            *corrections.force_mut(vertex) = force;
            if mass > 0.0 {
                corrections.max_displacement_m = corrections.max_displacement_m.max(force.norm() / mass);
            }
        }
    }
}

/// Mass of a vertex; 1 kg where the mesh has none.
pub(crate) fn mass_kg(mesh: &Mesh, vertex: VertexId) -> f64 {
    mesh.masses_kg().map_or(1.0, |masses| masses[vertex.index()])
}

/// Mass that a point of the cloth stands for.
pub(crate) fn mass_at(mesh: &Mesh, point: &MaterialPoint) -> f64 {
    point.vertices.iter().zip(point.weights).map(|(&vertex, weight)| weight * mass_kg(mesh, vertex)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    #[test]
    fn finish_limits_sums_and_skips_pinned_vertices() {
        let mesh = Mesh::new(MeshDescription {
            num_vertices: 6,
            faces: vec![[0, 1, 2], [3, 4, 5]],
            pins: vec![3],
            masses_kg: Some(vec![2.0; 6]),
            ..Default::default()
        })
        .unwrap();
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut forces = Forces::default();
        for _ in 0..2 {
            forces.reset(6);
            let mut corrections = Corrections {
                forces: vec![Vector3::zeros(); 6],
                flags: vec![VertexFlags::default(); 6],
                ..Default::default()
            };
            let near = MaterialPoint::vertex(VertexId(0));
            let far = MaterialPoint { vertices: [3, 4, 5].map(VertexId), weights: [0.5, 0.25, 0.25] };
            let along = (far.position(&frame) - near.position(&frame)).normalize();
            forces.add_pair(&near, &far, along, 0.1);
            forces.finish(&mesh, &frame, &mut corrections);
            assert!(corrections.net_force.norm() < 1e-15 && corrections.net_torque.norm() < 1e-15);
            assert!((corrections.forces[0] - along * 0.6).norm() < 1e-15);
            assert!(corrections.flags[0].contains(VertexFlags::CLAMPED));
            assert_eq!(corrections.forces[3], Vector3::zeros());
            assert!((corrections.forces[4] + along * 0.25).norm() < 1e-15);
            assert_eq!(corrections.flags[4], VertexFlags::default());
            assert!((corrections.max_displacement_m - 0.3).abs() < 1e-15);
        }
    }
}
