//! Displacements of one step along a path, carried on to its surroundings: what has to move with it.

use std::collections::BinaryHeap;

use nalgebra::{Matrix3, Point3, Vector3};

use super::{
    law::limited,
    sums::{Forces, mass_kg},
};
use crate::{
    frame::Frame,
    geodesic::TrialVertex,
    mesh::{Mesh, VertexId},
    sparse_map::SparseMap,
};

/// How far a field goes along the edges, as a multiple of the depth of a tangle: of 1, 2 and 4, tried on the scenes of
/// `host_table` whose paths are pushed, farther was faster.
const RADIUS_PER_DEPTH: f64 = 4.0;
/// Directions about which the vertices have less inertia than this part of the largest are those of a line.
const NO_INERTIA: f64 = 1e-12;

/// Carries steps from the vertices along a path to those within a distance along the edges, fading, and without a net
/// force or torque. A force on the path alone moves less and less the finer the mesh is, since its faces have less and
/// less mass.
#[derive(Debug, Default)]
pub(crate) struct Spread {
    reached: SparseMap<VertexId, Reached>,
    front: BinaryHeap<TrialVertex>,
    /// What the field moves, in the order of distance.
    moved: Vec<Moved>,
}

/// What a vertex gets from those before it.
#[derive(Clone, Copy, Debug)]
struct Reached {
    sum: Vector3<f64>,
    weight: f64,
    distance_m: f64,
    is_final: bool,
}

impl Default for Reached {
    fn default() -> Self {
        Self { sum: Vector3::zeros(), weight: 0.0, distance_m: f64::INFINITY, is_final: false }
    }
}

/// How strong a field is, and how far it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Field {
    pub(crate) part: f64,
    pub(crate) radius_m: f64,
    pub(crate) largest_m: f64,
}

impl Field {
    /// The field round a path in a tangle of a depth. Where the mesh is coarser than the tangle there is none: there
    /// the faces along a path are all that has to move.
    pub(crate) fn of_tangle(depth_m: f64, edge_length_m: f64, largest_m: f64) -> Self {
        let part = if depth_m > edge_length_m { 1.0 - edge_length_m / depth_m } else { 0.0 };
        Self { part, radius_m: RADIUS_PER_DEPTH * part * depth_m, largest_m }
    }
}

#[derive(Clone, Copy, Debug)]
struct Moved {
    vertex: VertexId,
    force: Vector3<f64>,
    /// Its mass times how much the field has faded.
    mass_kg: f64,
}

impl Spread {
    /// Makes ready for the steps of another path.
    pub(crate) fn reset(&mut self, num_vertices: usize) {
        self.reached.reset(num_vertices);
        self.front.clear();
    }

    /// A step of a vertex on the path, in metres; the mean where there are several.
    pub(crate) fn seed(&mut self, vertex: VertexId, step: Vector3<f64>) {
        let reached = self.reached.entry(vertex);
        reached.sum += step;
        reached.weight += 1.0;
        if reached.distance_m > 0.0 {
            reached.distance_m = 0.0;
            self.front.push(TrialVertex { distance_m: 0.0, vertex });
        }
    }

    /// Adds `part` of the forces on all vertices nearer than `radius_m` to the path. No step is longer than
    /// `largest_m`.
    ///
    /// Cost: O(n log n) in the vertices within the radius.
    pub(crate) fn add_to(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        Field { part, radius_m, largest_m }: Field,
        forces: &mut Forces,
    ) {
        if part <= 0.0 {
            return;
        }
        self.moved.clear();
        while let Some(TrialVertex { distance_m, vertex }) = self.front.pop() {
            let reached = self.reached.entry(vertex);
            if std::mem::replace(&mut reached.is_final, true) {
                continue;
            }
            let step = reached.sum / reached.weight;
            let mass_kg = part * (1.0 - distance_m / radius_m) * mass_kg(mesh, vertex);
            self.moved.push(Moved { vertex, force: limited(step, largest_m) * mass_kg, mass_kg });
            self.offer_neighbours(mesh, frame, vertex, step, distance_m, radius_m);
        }
        balance(&mut self.moved, frame);
        for Moved { vertex, force, .. } in &self.moved {
            forces.add(*vertex, *force, largest_m);
        }
    }

    /// A vertex that was reached passes its step on: neighbours get the mean of what is nearer to the path, so that
    /// steps from both sides of it blend where they meet.
    fn offer_neighbours(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        vertex: VertexId,
        step: Vector3<f64>,
        distance_m: f64,
        radius_m: f64,
    ) {
        for &edge in mesh.vertex_edges(vertex) {
            let next = mesh.opposite_vertex(edge, vertex);
            let length_m = (frame.position(next) - frame.position(vertex)).norm();
            let through_m = distance_m + length_m;
            // Edges of no length pass nothing on: what lies in one place is reached over another edge.
            if length_m <= 0.0 || through_m >= radius_m {
                continue;
            }
            let reached = self.reached.entry(next);
            if reached.is_final || reached.distance_m <= 0.0 {
                continue;
            }
            reached.sum += step / length_m;
            reached.weight += length_m.recip();
            if through_m < reached.distance_m {
                reached.distance_m = through_m;
                self.front.push(TrialVertex { distance_m: through_m, vertex: next });
            }
        }
    }
}

/// Takes the net force and the net torque away, by a rigid motion of what is moved.
fn balance(moved: &mut [Moved], frame: &Frame) {
    let mass: f64 = moved.iter().map(|moved| moved.mass_kg).sum();
    if mass <= 0.0 {
        moved.iter_mut().for_each(|moved| moved.force = Vector3::zeros());
        return;
    }
    let weighted = moved.iter().map(|moved| frame.position(moved.vertex).coords * moved.mass_kg);
    let centre = Point3::from(weighted.sum::<Vector3<f64>>() / mass);
    let (mut force, mut torque, mut inertia) = (Vector3::zeros(), Vector3::zeros(), Matrix3::zeros());
    for moved in moved.iter() {
        let arm = frame.position(moved.vertex) - centre;
        force += moved.force;
        torque += arm.cross(&moved.force);
        inertia += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * moved.mass_kg;
    }
    let eigen = inertia.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut turn = Vector3::zeros();
    for (axis, &inertia) in eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter()) {
        if inertia > NO_INERTIA * largest {
            turn += axis * (axis.dot(&torque) / inertia);
        }
    }
    for moved in moved {
        let arm = frame.position(moved.vertex) - centre;
        moved.force -= (force / mass + turn.cross(&arm)) * moved.mass_kg;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        correspond::samples::sheet,
        respond::{Corrections, VertexFlags},
    };

    /// The forces that seeds in the middle column of a sheet of `2 n x 2 n` squares of side 1 / n spread within 0.6 m:
    /// upwards on the left half of the column, downwards on the right.
    fn field(n: u32) -> (Mesh, Frame, Corrections) {
        let (mesh, flat) = sheet(2 * n, 2 * n, 1.0 / f64::from(n));
        let positions: Vec<_> = flat.iter().map(|point| [point.x, point.y, 0.1 * (3.0 * point.x).sin()]).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let (mut spread, mut forces) = (Spread::default(), Forces::default());
        let mut corrections = Corrections::default();
        for _ in 0..2 {
            spread.reset(mesh.num_vertices());
            forces.reset(mesh.num_vertices());
            for vertex in mesh.vertex_ids().filter(|vertex| (flat[vertex.index()].x - 1.0).abs() < 1e-9) {
                let y = flat[vertex.index()].y;
                spread.seed(vertex, Vector3::new(0.0, 0.0, 0.01 * if y < 0.7 { 1.0 } else { -1.0 }));
            }
            let field = Field { part: 1.0, radius_m: 0.6, largest_m: 0.01 };
            spread.add_to(&mesh, &frame, field, &mut forces);
            corrections = Corrections {
                forces: vec![Vector3::zeros(); mesh.num_vertices()],
                flags: vec![VertexFlags::default(); mesh.num_vertices()],
                ..Default::default()
            };
            forces.finish(&mesh, &frame, &mut corrections);
        }
        (mesh, frame, corrections)
    }

    #[test]
    fn spread_steps_fade_to_nothing_and_keep_both_momenta() {
        let (mesh, frame, corrections) = field(8);
        let sum: f64 = corrections.forces.iter().map(Vector3::norm).sum();
        assert!(sum > 0.1, "{sum}");
        assert!(corrections.net_force.norm() < 1e-14 * sum && corrections.net_torque.norm() < 1e-14 * sum);
        for vertex in mesh.vertex_ids() {
            let away = (frame.position(vertex).x - 1.0).abs();
            let size = corrections.forces[vertex.index()].norm();
            assert_eq!(size > 0.0, away < 0.6 - 1e-9, "{away}: {size}");
            assert!(size < 0.02, "{size}");
        }
    }

    #[test]
    fn spread_steps_of_finer_sheets_are_the_same() {
        let at = |n: u32, x: u32, y: u32| {
            let (_, _, corrections) = field(n);
            corrections.forces[(y * n / 4 * (2 * n + 1) + x * n / 4) as usize]
        };
        for (x, y) in [(3, 1), (5, 1), (3, 6), (5, 6)] {
            let [coarse, fine] = [8, 16].map(|n| at(n, x, y));
            assert!((coarse - fine).norm() < 0.1 * 0.01, "{x} {y}: {coarse:?} {fine:?}");
        }
    }
}
