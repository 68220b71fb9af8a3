//! What is left, and why.

use super::{BlockedPath, solver::End};
use crate::{analysis::Analysis, mesh::Mesh};

/// The paths of a state that is the best one that was found, where the last way to go ended so.
pub(super) fn blocked_paths(mesh: &Mesh, analysis: &Analysis, end: End) -> Vec<BlockedPath> {
    let closed = mesh.closed_pieces();
    let pairs = analysis.paths.pairs.iter();
    pairs
        .map(|pair| {
            let first = &analysis.paths.copies[pair.copies.start];
            let segment = &analysis.paths.segments[first.segments.start];
            let is_closed = |face| mesh.piece(face).is_some_and(|piece| closed[piece.index()]);
            let reason = reason(end, is_closed(segment.own) || is_closed(segment.partner));
            let vertex = mesh.face(segment.own)[0].0;
            BlockedPath { pair_type: pair.pair_type, vertex, length_m: pair.length_m, reason: reason.into() }
        })
        .collect()
}

fn reason(end: End, meets_closed: bool) -> &'static str {
    match (end, meets_closed) {
        (End::Clean, _) => "",
        (End::Exhausted, _) => "the largest number of iterations was reached",
        (End::Interrupted, _) => "the work was interrupted",
        (End::Stuck, false) => "no motion left it shorter without crushing or overstretching the cloth",
        (End::Stuck, true) => {
            "no motion left it shorter without crushing or overstretching the cloth, and a piece without a boundary can't be drawn flat"
        }
    }
}
