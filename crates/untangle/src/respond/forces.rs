//! Where forces are summed: opposite pairs, each spread over the vertices of the face in which it acts.

use nalgebra::{Point3, Vector3};

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{Mesh, VertexId},
    respond::{Corrections, VertexFlags},
};

/// The sum of a vertex is limited to this many times the largest correction of one path.
const LARGEST_SUM: f64 = 3.0;

/// The law that turns a distance into a displacement of one step, for one path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ForceLaw {
    /// Part of the distance that one step covers.
    pub(crate) stiffness: f64,
    /// Half of the gap that shall be left between the sheets, in metres.
    pub(crate) offset_m: f64,
    /// Largest displacement of one step, in metres.
    pub(crate) largest_m: f64,
}

impl ForceLaw {
    /// `min(k (d + h/2), f_max)`, in metres of displacement of one step.
    ///
    /// Equation 4 of Wicke, Lanker and Gross (2006) prints `max`; its text means `min`. Their law vanishes as the gap closes, where the
    /// stiffness of the cloth stalls it: hence the offset.
    pub(crate) fn step(&self, distance_m: f64) -> f64 {
        (self.stiffness * (distance_m + self.offset_m)).min(self.largest_m)
    }
}

/// Sums of forces, in kg m / step^2, with what is needed to limit them.
#[derive(Debug, Default)]
pub(crate) struct Forces {
    sums: Vec<Vector3<f64>>,
    /// For each vertex the largest displacement of one step that some path grants it; zero where nothing acts.
    limits_m: Vec<f64>,
    /// Vertices on which something acts, in the order met.
    touched: Vec<VertexId>,
}

impl Forces {
    /// Begins anew.
    pub(crate) fn start(&mut self, num_vertices: usize) {
        for vertex in self.touched.drain(..) {
            self.sums[vertex.index()] = Vector3::zeros();
            self.limits_m[vertex.index()] = 0.0;
        }
        self.sums.resize(num_vertices, Vector3::zeros());
        self.limits_m.resize(num_vertices, 0.0);
    }

    /// Adds a force on one vertex.
    pub(crate) fn add(&mut self, vertex: VertexId, force: Vector3<f64>, limit_m: f64) {
        let limit = &mut self.limits_m[vertex.index()];
        if *limit == 0.0 {
            self.touched.push(vertex);
        }
        *limit = limit.max(limit_m.max(f64::MIN_POSITIVE));
        self.sums[vertex.index()] += force;
    }

    /// Adds a force at a point and its opposite at another. With both in one place, or the force along the line between them, neither the
    /// sum of all forces nor that of all torques changes.
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
        // An order of their own, so that the sums below don't depend on that of the paths.
        self.touched.sort_unstable();
        let mut centre = Vector3::zeros();
        for &vertex in &self.touched {
            corrections.net_force += self.sums[vertex.index()];
            centre += frame.position(vertex).coords;
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of vertices")]
        let centre = Point3::from(centre / self.touched.len().max(1) as f64);
        for &vertex in &self.touched {
            let mut force = self.sums[vertex.index()];
            corrections.net_torque += (frame.position(vertex) - centre).cross(&force);
            if mesh.is_pinned(vertex) {
                continue;
            }
            let mass = mass_kg(mesh, vertex);
            let largest = LARGEST_SUM * self.limits_m[vertex.index()] * mass;
            let size = force.norm();
            if size > largest {
                force *= largest / size;
                corrections.flags[vertex.index()].insert(VertexFlags::CLAMPED);
            }
            corrections.forces[vertex.index()] = force;
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
    fn the_law_grows_from_the_offset_to_its_limit() {
        let law = ForceLaw { stiffness: 0.5, offset_m: 0.01, largest_m: 0.02 };
        assert!((law.step(0.0) - 0.005).abs() < 1e-15);
        assert!((law.step(0.01) - 0.01).abs() < 1e-15);
        assert!((law.step(7.0) - 0.02).abs() < 1e-15);
    }

    #[test]
    fn sums_are_limited_and_pins_are_left_alone() {
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
            forces.start(6);
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
