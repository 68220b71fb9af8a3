//! Displacements that end: what moved by next to nothing goes back to where it was.

use nalgebra::Point3;

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{EdgeId, FaceId, Mesh},
    relax::{
        relaxer::Relaxer,
        step::{is_movable, stored},
    },
};

/// All displacements get shorter by this part of the largest one, of the island where that is least; those that are
/// shorter end there.
const PART: f64 = 0.02;
/// How often that is halved where something would intersect.
const MAX_HALVINGS: usize = 3;

/// Positions with displacements that end, each continuous in that of the present state; nothing where something would
/// intersect that does not now, or enter a body. Vertices whose displacement ended have the position of the input.
///
/// Cost: a search for intersections for each attempt.
pub(super) fn taper(relaxer: &Relaxer<'_>) -> Option<Vec<Point3<f64>>> {
    let Relaxer { mesh, frame, sides, settings, .. } = relaxer;
    let inside = |positions: &[Point3<f64>]| sides.as_ref().map_or(0, |sides| sides.wrong_vertices(positions).len());
    let present = movable(mesh, frame);
    let num_inside = inside(frame.positions());
    let mut shorter_m = PART * least_of_largest_m(relaxer)?;
    let mut tapered = Frame::default();
    for _ in 0..=MAX_HALVINGS {
        let positions: Vec<Point3<f64>> = mesh
            .vertex_ids()
            .map(|vertex| stored(shortened(relaxer, vertex.index(), shorter_m), settings.single_precision))
            .collect();
        if (relaxer.should_stop)() || tapered.set(mesh, positions.iter().map(|point| (*point).into())).is_err() {
            return None;
        }
        let is_old = |found: &(EdgeId, FaceId)| present.binary_search(found).is_ok();
        if movable(mesh, &tapered).iter().all(is_old) && inside(&positions) <= num_inside {
            return Some(positions);
        }
        shorter_m *= 0.5;
    }
    None
}

/// The position of a vertex whose displacement gets shorter; that of the input where it ends.
fn shortened(relaxer: &Relaxer<'_>, vertex: usize, shorter_m: f64) -> Point3<f64> {
    let (input, now) = (relaxer.rest.positions()[vertex], relaxer.frame.positions()[vertex]);
    let displacement = now - input;
    let length_m = displacement.norm();
    if length_m <= shorter_m { input } else { input + displacement * (1.0 - shorter_m / length_m) }
}

/// The largest displacement of each island, and of these the least; nothing where nothing moved.
fn least_of_largest_m(relaxer: &Relaxer<'_>) -> Option<f64> {
    let Relaxer { mesh, frame, rest, first_islands, .. } = relaxer;
    let mut largest = vec![0.0f64; first_islands.len()];
    for vertex in mesh.vertex_ids() {
        if let Some(island) = first_islands.near(vertex) {
            largest[island] = largest[island].max((frame.position(vertex) - rest.position(vertex)).norm());
        }
    }
    largest.into_iter().filter(|&length_m| length_m > 0.0).min_by(f64::total_cmp)
}

/// What intersects in a state, of what a motion can change, in order.
fn movable(mesh: &Mesh, frame: &Frame) -> Vec<(EdgeId, FaceId)> {
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, frame, &mut found);
    let movable = found.edge_face.iter().filter(|found| is_movable(mesh, found));
    movable.map(|found| (found.edge, found.face)).collect()
}
