//! What the solver knows of the input before it moves anything.

use super::{
    plan::{Largest, are_copies_in_one_place, is_beyond_trials},
    relaxer::Relaxer,
};
use crate::{
    analysis::Analysis,
    intersect::{Intersections, Intersector, Segment},
    paths::PathPair,
    settings::InsideChoice,
};

/// Analyses the input. Gives back what there is to know about the island of paths that has most.
pub(super) fn analyse_input(relaxer: &mut Relaxer<'_>) -> Largest {
    let mut found = Intersections::default();
    Intersector::default().intersect(relaxer.mesh, &relaxer.frame, &mut found);
    let many = is_beyond_trials(found.edge_face.len());
    let wanted = relaxer.analysis_settings.inside;
    if many {
        // The size of the largest island needs no better choice, and of so many paths the others take minutes.
        relaxer.analysis_settings.inside = InsideChoice::Count;
    }
    relaxer.analyse();
    relaxer.measure_islands(0);
    let largest = largest_island(relaxer);
    if many && !largest.is_crowded() {
        relaxer.analysis_settings.inside = wanted;
        relaxer.analyse();
    }
    let positions = relaxer.frame.positions();
    let wrong = relaxer.sides.as_ref().map(|sides| sides.wrong_groups(relaxer.mesh, positions)).unwrap_or_default();
    relaxer.first_islands.find(relaxer.mesh, relaxer.analyser.last(), &wrong, usize::MAX / 2);
    largest
}

/// The island that has most intersections, of those that were measured last.
fn largest_island(relaxer: &Relaxer<'_>) -> Largest {
    let Relaxer { mesh, frame, analyser, islands, now, .. } = relaxer;
    let Analysis { intersections, paths, .. } = analyser.last();
    let island = (0..now.len()).rev().max_by_key(|&island| now[island].num_edge_face).unwrap_or(0);
    let is_here = |pair: &&PathPair| {
        let first = &paths.segments[paths.copies[pair.copies.start].segments.start];
        let face = if mesh.is_body_face(first.own) { first.partner } else { first.own };
        islands.of(mesh.face(face)[0]) == island
    };
    let closed = mesh.closed_pieces();
    let is_flattenable = |segment: &&Segment| {
        let [a, b] = segment.faces.map(|face| mesh.piece(face));
        a == b && a.is_some_and(|piece| !closed[piece.index()])
    };
    let num_flattenable = intersections.segments.iter().filter(is_flattenable).count();
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let flattenable = num_flattenable as f64 / intersections.segments.len().max(1) as f64;
    Largest {
        num_edge_face: now.get(island).map_or(0, |tangle| tangle.num_edge_face),
        num_pairs: paths.pairs.iter().filter(is_here).count(),
        flattenable,
        is_copy: are_copies_in_one_place(mesh, frame, &intersections.segments),
    }
}
