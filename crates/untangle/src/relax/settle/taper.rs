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

/// Displacements up to this part of the largest one, of the island where that is least, end.
const PART: f64 = 0.1;
/// From this many times that on they stay as they are; in between they get shorter.
const FULL: f64 = 3.0;
/// How often that part is halved where something would intersect, or be strained.
const MAX_HALVINGS: usize = 3;
/// Strains up to this logarithm may grow.
const SMALL_STRAIN: f64 = 0.03;

/// Positions with displacements that end where they are small, and stay as they are where they are large: at contacts.
/// Nothing where something would intersect that does not now, enter a body, or be strained more. Vertices whose
/// displacement ended have the position of the input.
///
/// Cost: a search for intersections for each attempt.
pub(super) fn taper(relaxer: &Relaxer<'_>) -> Option<Vec<Point3<f64>>> {
    let Relaxer { mesh, frame, sides, settings, .. } = relaxer;
    let inside =
        |positions: &[Point3<f64>]| sides.as_ref().map_or(0, |sides| sides.wrong_vertices(mesh, positions).len());
    let present = movable(mesh, frame);
    let num_inside = inside(frame.positions());
    let mut ended_m = PART * least_of_largest_m(relaxer)?;
    let strain = largest_strain(relaxer, frame.positions()).max(SMALL_STRAIN);
    let mut tapered = Frame::default();
    for _ in 0..=MAX_HALVINGS {
        let positions: Vec<Point3<f64>> = mesh
            .vertex_ids()
            .map(|vertex| stored(shortened(relaxer, vertex.index(), ended_m), settings.single_precision))
            .collect();
        if (relaxer.should_stop)() || tapered.set(mesh, positions.iter().map(|point| (*point).into())).is_err() {
            return None;
        }
        let is_old = |found: &(EdgeId, FaceId)| present.binary_search(found).is_ok();
        if largest_strain(relaxer, &positions) <= strain
            && inside(&positions) <= num_inside
            && movable(mesh, &tapered).iter().all(is_old)
        {
            return Some(positions);
        }
        ended_m *= 0.5;
    }
    None
}

/// The position of a vertex whose displacement gets shorter, the shorter the more; that of the input where it ends.
fn shortened(relaxer: &Relaxer<'_>, vertex: usize, ended_m: f64) -> Point3<f64> {
    let (input, now) = (relaxer.rest.positions()[vertex], relaxer.frame.positions()[vertex]);
    let displacement = now - input;
    let length_m = displacement.norm();
    if length_m <= ended_m {
        input
    } else if length_m < FULL * ended_m {
        input + displacement * ((length_m - ended_m) / length_m * (FULL / (FULL - 1.0)))
    } else {
        now
    }
}

/// The largest logarithm of an edge's length over that in the input.
pub(in crate::relax) fn largest_strain(relaxer: &Relaxer<'_>, positions: &[Point3<f64>]) -> f64 {
    let Relaxer { mesh, limits, .. } = relaxer;
    mesh.edge_ids().map(|edge| limits.strain(mesh, positions, edge)).fold(0.0, f64::max)
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
