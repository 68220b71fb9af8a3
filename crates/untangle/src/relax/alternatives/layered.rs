//! An attempt with the order in which most of each piece lies, where pieces that intersect lie over each other.

use super::{ends::CleanEnd, ways::Way};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, PieceId, VertexId},
    relax::{
        outcome::RelaxError, plan::Largest, relaxer::Relaxer, settings::Effort, sides::SideTracker, step::is_movable,
    },
    sides::with_implied_layers,
};

/// A clean end of an attempt with layers.
pub(in crate::relax) struct LayeredEnd {
    pub(in crate::relax) end: CleanEnd,
    /// Whether all that the order calls wrong belongs to what intersects: a collar that is tucked in does not, and
    /// nobody asked to move it.
    pub(in crate::relax) is_of_tangle: bool,
}

/// Where the first descent ends if pieces that lie over each other belong where most of each is; nothing where no
/// order is clear, bodies or layers say it, or that is not clean.
///
/// Cost: that of an attempt.
pub(in crate::relax) fn end_in_implied_order(
    relaxer: &Relaxer<'_>,
    largest: Largest,
) -> Result<Option<LayeredEnd>, RelaxError> {
    let settings = relaxer.settings;
    let is_allowed = settings.other_attempts && settings.effort != Effort::Fast && relaxer.sides.is_none();
    let meetings = if is_allowed { meetings(relaxer) } else { Vec::new() };
    if meetings.is_empty() {
        return Ok(None);
    }
    let Some(mesh) = with_implied_layers(relaxer.mesh, &relaxer.frame, &meetings) else { return Ok(None) };
    let end = Way::Layered(&mesh).end(relaxer, largest)?;
    let is_of_tangle = is_of_tangle(relaxer, &mesh);
    Ok(end.filter(|end| is_clean(relaxer, end)).map(|end| LayeredEnd { end, is_of_tangle }))
}

/// The pairs of pieces with a boundary that intersect each other, in order.
fn meetings(relaxer: &Relaxer<'_>) -> Vec<[PieceId; 2]> {
    let mesh = relaxer.mesh;
    let closed = mesh.closed_pieces();
    let segments = relaxer.analyser.last().intersections.segments.iter();
    let pieces = segments.filter_map(|segment| match segment.faces.map(|face| mesh.piece(face)) {
        [Some(a), Some(b)] if a != b && !closed[a.index()] && !closed[b.index()] => Some([a.min(b), a.max(b)]),
        _ => None,
    });
    let mut meetings: Vec<[PieceId; 2]> = pieces.collect();
    meetings.sort_unstable();
    meetings.dedup();
    meetings
}

/// Whether edges join each vertex on the wrong side, along others there, with a face that intersects something.
fn is_of_tangle(relaxer: &Relaxer<'_>, layered: &Mesh) -> bool {
    let Some(sides) = SideTracker::of(layered, &relaxer.frame) else { return true };
    let wrong = sides.wrong_vertices(layered, relaxer.frame.positions());
    let segments = &relaxer.analyser.last().intersections.segments;
    let mut is_reached = vec![false; layered.num_vertices()];
    let mut stack: Vec<VertexId> =
        segments.iter().flat_map(|segment| segment.faces).flat_map(|face| layered.face(face)).collect();
    stack.iter().for_each(|vertex| is_reached[vertex.index()] = true);
    while let Some(vertex) = stack.pop() {
        for &edge in layered.vertex_edges(vertex) {
            let next = layered.opposite_vertex(edge, vertex);
            if !is_reached[next.index()] && wrong.binary_search(&next).is_ok() {
                is_reached[next.index()] = true;
                stack.push(next);
            }
        }
    }
    wrong.iter().all(|vertex| is_reached[vertex.index()])
}

/// Whether nothing intersects that a motion can change: what hangs on pins ends an attempt with layers too.
fn is_clean(relaxer: &Relaxer<'_>, end: &CleanEnd) -> bool {
    let mut frame = Frame::default();
    if frame.set(relaxer.mesh, end.positions.iter().map(|point| (*point).into())).is_err() {
        return false;
    }
    let mut found = Intersections::default();
    Intersector::default().intersect(relaxer.mesh, &frame, &mut found);
    !found.edge_face.iter().any(|found| is_movable(relaxer.mesh, found))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use nalgebra::Point3;

    use super::*;
    use crate::relax::{RelaxSettings, escape::tests::samples::Pieces, relax};

    /// How far the mean vertex moved, and how many vertices of the second piece are behind the first one.
    fn relaxed(pieces: &Pieces) -> (f64, usize) {
        let (mesh, frame) = pieces.mesh();
        let found = relax(&mesh, &pieces.positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(()));
        let found = found.unwrap();
        assert!(found.blocked.is_empty());
        let positions: Vec<Point3<f64>> = found.positions.iter().map(|&at| at.into()).collect();
        let moved_m: f64 = frame.positions().iter().zip(&positions).map(|(a, b)| (a - b).norm()).sum();
        let second = u32::try_from(positions.len() / 2).unwrap();
        let layered = mesh.with_layers(mesh.vertex_ids().map(|vertex| u32::from(vertex.0 >= second)).collect());
        let behind = SideTracker::of(&layered, &frame).unwrap().wrong_vertices(&layered, &positions);
        (moved_m / f64::from(2 * second), behind.len())
    }

    #[test]
    fn sleeve_that_lies_outside_for_the_most_part_ends_outside_by_short_ways_at_any_edge() {
        let mut means_m = Vec::new();
        for squares in [24, 48] {
            let (moved_m, num_behind) = relaxed(&Pieces::sleeves(squares, 0.03));
            println!("{squares}: {moved_m} {num_behind}");
            assert_eq!(num_behind, 0, "{squares}");
            means_m.push(moved_m);
        }
        assert!(means_m.iter().all(|mean_m| *mean_m < 0.0042), "{means_m:?}");
    }
}
