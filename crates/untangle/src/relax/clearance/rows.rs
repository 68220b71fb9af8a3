//! Separation constraints of pairs that are to be set apart, or to stay apart.

use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::Mesh,
    proximity::{Primitives, closest_points, direction_apart},
    relax::constraints::Constraints,
};

/// Adds the constraint that the closest points of a pair are to be `wanted_m` apart.
pub(super) fn add_row(
    constraints: &mut Constraints,
    mesh: &Mesh,
    frame: &Frame,
    primitives: Primitives,
    wanted_m: f64,
) {
    let closest = closest_points(mesh, frame, primitives);
    let [own, partner] =
        [0, 1].map(|side| MaterialPoint { vertices: closest.vertices[side], weights: closest.weights[side] });
    if let Some(direction) = direction_apart(mesh, frame, primitives, &closest) {
        constraints.separate(&own, &partner, direction, wanted_m - closest.offset.norm());
    }
}
