//! An attempt with the order in which most of each piece lies, where pieces that intersect lie over each other.

use super::{
    ends::CleanEnd,
    is_near,
    ways::{Way, WayEnd},
};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, VertexId},
    relax::{
        outcome::{BestState, Iteration, RelaxError},
        plan::Largest,
        relaxer::{Progress, Relaxer},
        settings::Effort,
        step::num_movable,
    },
    sides::{ImpliedLayers, Layers},
};

/// How an attempt with layers ended.
pub(in crate::relax) enum LayeredAttempt {
    /// It was not made, as no order is clear, layers say it or the effort is too small, or it did not end clean.
    Nothing,
    Clean(LayeredEnd),
    /// The caller asked for it; the best state so far, and its history.
    Interrupted(BestState, Vec<Iteration>),
}

/// A clean end of an attempt with layers.
pub(in crate::relax) struct LayeredEnd {
    pub(super) end: CleanEnd,
    /// Whether all that the order calls wrong belongs to what intersects: a collar that is tucked in does not, and
    /// nobody asked to move it.
    is_of_tangle: bool,
}

impl LayeredEnd {
    pub(in crate::relax) fn into_end(self) -> CleanEnd {
        self.end
    }

    /// Whether no other attempt is needed.
    pub(in crate::relax) fn is_enough(&self) -> bool {
        self.is_of_tangle && is_near(&self.end) && !self.end.is_beyond_limits()
    }
}

/// Where the first descent ends if pieces that lie over each other belong where most of each is.
///
/// Cost: that of an attempt.
pub(in crate::relax) fn attempt_in_implied_order(
    relaxer: &Relaxer<'_>,
    largest: Largest,
    progress: &mut Progress<'_>,
) -> Result<LayeredAttempt, RelaxError> {
    if relaxer.settings.effort == Effort::Fast {
        return Ok(LayeredAttempt::Nothing);
    }
    let found = &relaxer.analyser.last().intersections;
    let Some(ImpliedLayers { mesh, .. }) = ImpliedLayers::of(relaxer.mesh, &relaxer.frame, found) else {
        return Ok(LayeredAttempt::Nothing);
    };
    Ok(match Way::Layered(&mesh).run(relaxer, largest, progress)? {
        WayEnd::Clean(end) if is_clean(relaxer, &end) => {
            LayeredAttempt::Clean(LayeredEnd { end, is_of_tangle: is_of_tangle(relaxer, &mesh) })
        }
        WayEnd::Interrupted(best, history) => LayeredAttempt::Interrupted(best, history),
        WayEnd::Clean(_) | WayEnd::Stuck => LayeredAttempt::Nothing,
    })
}

/// Whether edges join each vertex behind a layer, along others there, with a face that intersects something.
fn is_of_tangle(relaxer: &Relaxer<'_>, layered: &Mesh) -> bool {
    let Some(layers) = Layers::of(layered, &relaxer.frame, None) else { return true };
    let wrong = layers.behind(layered, relaxer.frame.positions());
    let is_wrong = |vertex| wrong.binary_search_by_key(&vertex, |wrong| wrong.vertex).is_ok();
    let segments = &relaxer.analyser.last().intersections.segments;
    let mut is_reached = vec![false; layered.num_vertices()];
    let mut stack: Vec<VertexId> =
        segments.iter().flat_map(|segment| segment.faces).flat_map(|face| layered.face(face)).collect();
    stack.iter().for_each(|vertex| is_reached[vertex.index()] = true);
    while let Some(vertex) = stack.pop() {
        for &edge in layered.vertex_edges(vertex) {
            let next = layered.opposite_vertex(edge, vertex);
            if !is_reached[next.index()] && is_wrong(next) {
                is_reached[next.index()] = true;
                stack.push(next);
            }
        }
    }
    wrong.iter().all(|wrong| is_reached[wrong.vertex.index()])
}

/// Whether nothing intersects that a motion can change, and nothing is inside of bodies: what hangs on pins ends an
/// attempt with layers too.
fn is_clean(relaxer: &Relaxer<'_>, end: &CleanEnd) -> bool {
    let mut frame = Frame::default();
    if frame.set(relaxer.mesh, end.positions.iter().map(|point| (*point).into())).is_err() {
        return false;
    }
    let mut found = Intersections::default();
    Intersector::default().intersect(relaxer.mesh, &frame, &mut found);
    let num_wrong = relaxer.sides.as_ref().map_or(0, |sides| sides.wrong(relaxer.mesh, &end.positions).len());
    num_wrong == 0 && num_movable(relaxer.mesh, &found) == 0
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use nalgebra::Point3;

    use crate::{
        analysis::analyse,
        frame::Frame,
        relax::{Iteration, RelaxSettings, escape::tests::samples::Pieces, relax, sides::SideTracker},
    };

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
    fn work_that_ends_within_the_attempt_leaves_its_best_state() {
        let pieces = Pieces::sleeves(24, 0.03);
        let (mesh, frame) = pieces.mesh();
        let num_before = analyse(&mesh, &frame).intersections.edge_face.len();
        let mut num_calls = 0;
        let mut once = |_: &Iteration| {
            num_calls += 1;
            ControlFlow::Break(())
        };
        let found = relax(&mesh, &pieces.positions, &RelaxSettings::default(), &mut once).unwrap();
        let after = Frame::new(&mesh, &found.positions).unwrap();
        let num_after = analyse(&mesh, &after).intersections.edge_face.len();
        println!("{num_before} {num_after}");
        assert!(found.interrupted && num_calls == 1 && found.history.len() == 1);
        assert!(2 * num_after < num_before);
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
