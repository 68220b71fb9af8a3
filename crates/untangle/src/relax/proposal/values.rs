//! What corrections do to vertices, as it will be sent.

use nalgebra::Vector3;

use crate::{
    mesh::{Mesh, VertexId},
    relax::{energy::Domain, step::sent},
    respond::Corrections,
};

/// Takes the vertices that corrections move, and what they do to them, as it will be sent.
pub(super) fn take(mesh: &Mesh, corrections: &Corrections, domain: &mut Domain, displacement: &mut Vec<Vector3<f64>>) {
    let moved = |vertex: &VertexId| step_of(mesh, corrections, *vertex) != Vector3::zeros();
    domain.grow(mesh, corrections.touched.iter().copied().filter(moved), 0);
    displacement.clear();
    displacement.extend(domain.vertices().iter().map(|&vertex| step_of(mesh, corrections, vertex)));
}

/// The displacement of one step that a force makes, as it will be sent; none without mass.
pub(super) fn step_of(mesh: &Mesh, corrections: &Corrections, vertex: VertexId) -> Vector3<f64> {
    let mass_kg = mesh.masses_kg().map_or(1.0, |masses| masses[vertex.index()]);
    if mass_kg > 0.0 { sent(corrections.forces[vertex.index()] * (1.0 / mass_kg)) } else { Vector3::zeros() }
}
