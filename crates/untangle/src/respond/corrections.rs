//! What a stage writes into the corrections of a frame.

use nalgebra::Vector3;

use super::{Corrections, LeftOut, VertexFlags};
use crate::mesh::{Mesh, VertexId};

impl Corrections {
    /// Sets flags of a vertex.
    pub(crate) fn flag(&mut self, vertex: VertexId, flags: VertexFlags) {
        self.touch(vertex);
        self.flags[vertex.index()].insert(flags);
    }

    /// The force on a vertex, to be changed.
    pub(crate) fn force_mut(&mut self, vertex: VertexId) -> &mut Vector3<f64> {
        self.touch(vertex);
        &mut self.forces[vertex.index()]
    }

    /// Whether flags say that a vertex is in no tangle.
    pub(super) fn is_untangled(&self, vertex: VertexId) -> bool {
        let flags = self.flags[vertex.index()];
        !flags.contains(VertexFlags::INSIDE) && !flags.contains(VertexFlags::NEAR_PATH)
    }

    /// Notes a vertex whose force or flags are about to change. One that has either is noted already.
    fn touch(&mut self, vertex: VertexId) {
        if !self.is_touched(vertex) {
            self.touched.push(vertex);
        }
    }

    fn is_touched(&self, vertex: VertexId) -> bool {
        let VertexFlags(flags) = self.flags[vertex.index()];
        // By its bits, so that a negative zero does not stay for the next frame.
        flags & !VertexFlags::PINNED.0 != 0 || self.forces[vertex.index()].iter().any(|value| value.to_bits() != 0)
    }

    /// Lists the vertices that have a force or a flag other than pinned, each once, in order.
    ///
    /// Cost: a sort of the list; nothing where it is empty.
    pub(super) fn list_touched(&mut self) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&vertex| self.is_touched(vertex));
        self.touched = touched;
        debug_assert_eq!(
            (0..self.forces.len()).filter(|&index| self.is_touched(VertexId::from_index(index))).count(),
            self.touched.len(),
            "a force or a flag was set past `force_mut` and `flag`"
        );
    }

    /// Leaves out forces that are not finite: settings and masses at the limits of floating point can make such.
    pub(super) fn keep_finite(&mut self) {
        let is_finite = |vector: &Vector3<f64>| vector.iter().all(|value| value.is_finite());
        for vertex in &self.touched {
            let force = &mut self.forces[vertex.index()];
            if !is_finite(force) {
                *force = Vector3::zeros();
            }
        }
        for sum in [&mut self.net_force, &mut self.net_torque] {
            if !is_finite(sum) {
                *sum = Vector3::zeros();
            }
        }
        if !self.max_displacement_m.is_finite() {
            self.max_displacement_m = 0.0;
        }
    }

    /// Makes all values zero. Flags stay, but for that of values that were limited.
    ///
    /// Cost: linear in the vertices that were touched.
    pub(super) fn clear_values(&mut self) {
        for vertex in &self.touched {
            self.forces[vertex.index()] = Vector3::zeros();
            self.flags[vertex.index()].0 &= !VertexFlags::CLAMPED.0;
        }
        self.net_force = Vector3::zeros();
        self.net_torque = Vector3::zeros();
        self.max_displacement_m = 0.0;
    }

    /// Makes them those of a mesh, all zero but for the flags of pinned vertices.
    pub(super) fn begin(&mut self, mesh: &Mesh) {
        self.forces.clear();
        self.forces.resize(mesh.num_vertices(), Vector3::zeros());
        let pinned = |vertex| if mesh.is_pinned(vertex) { VertexFlags::PINNED } else { VertexFlags::default() };
        self.flags.clear();
        self.flags.extend(mesh.vertex_ids().map(pinned));
        self.touched.clear();
        self.reset();
    }

    /// Makes them what they were at the beginning.
    ///
    /// Cost: linear in the vertices that were touched.
    pub(super) fn reset(&mut self) {
        for vertex in self.touched.drain(..) {
            self.forces[vertex.index()] = Vector3::zeros();
            self.flags[vertex.index()].0 &= VertexFlags::PINNED.0;
        }
        self.labels.clear();
        self.net_force = Vector3::zeros();
        self.net_torque = Vector3::zeros();
        self.max_displacement_m = 0.0;
        self.left_out = LeftOut::default();
    }
}
