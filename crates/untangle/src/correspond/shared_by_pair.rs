//! What the second path of a pair reuses from the first.
//!
//! Where both have a region, the second needs the charts of the first, exchanged. Where both also list the same points
//! in the same order, as they do unless their parts were joined in another order, the lifts, the sides and the
//! separation constraints are those of the first, exchanged: only the fit is computed for each.

use std::ops::Range;

use super::{charts::ChartKind, correspondences::SeparationConstraint};
use crate::paths::{IntersectionPaths, PathPoint, PathSegment};

/// The charts that the first path of a pair leaves to the second.
#[derive(Debug)]
pub(super) struct SharedCharts {
    /// The first path.
    pub(super) copy: usize,
    /// The second, which may reuse them.
    pub(super) partner: usize,
    /// How the charts of the first and of the second path were made.
    pub(super) kinds: [ChartKind; 2],
    /// Where the second path lists the same points.
    pub(super) results: Option<SharedResults>,
}

/// The results of the first path that hold for the second too, once path and corresponding path are exchanged.
#[derive(Clone, Debug)]
pub(super) struct SharedResults {
    /// Sides of the inside along the first path, and along the second as far as a region says so.
    pub(super) sides: (f64, Option<f64>),
    /// The separation constraints of the first path, in those of all paths.
    pub(super) separations: Range<usize>,
}

/// Whether two paths list the same points in the same order, each with its own sheet first.
pub(super) fn have_same_points(paths: &IntersectionPaths, copies: [usize; 2]) -> bool {
    let [one, other] = copies.map(|copy| &paths.copies[copy]);
    let is_same_segment = |a: &PathSegment, b: &PathSegment| (a.own, a.partner) == (b.partner, b.own);
    let is_same_point = |a: &PathPoint, b: &PathPoint| (&a.own, &a.partner) == (&b.partner, &b.own);
    let [a, b] = [one, other].map(|path| &paths.segments[path.segments.clone()]);
    let [p, q] = [one, other].map(|path| &paths.points[path.points.clone()]);
    one.closed == other.closed
        && (a.len(), p.len()) == (b.len(), q.len())
        && a.iter().zip(b).all(|(a, b)| is_same_segment(a, b))
        && p.iter().zip(q).all(|(p, q)| is_same_point(p, q) && p.position == q.position)
}

/// Adds the separation constraints of the second path: those of the first, `of_first`, with their sheets exchanged.
pub(super) fn add_exchanged(separations: &mut Vec<SeparationConstraint>, of_first: Range<usize>) {
    for index in of_first {
        let SeparationConstraint { own, partner, position, direction, length_m } = separations[index];
        separations.push(SeparationConstraint {
            own: partner,
            partner: own,
            position,
            direction: -direction,
            length_m,
        });
    }
}
