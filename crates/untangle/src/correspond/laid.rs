//! What the second path of a pair takes over from the first.
//!
//! Where both have a region, the second needs the charts of the first, the other way round. Where both also name the same points in the same
//! order, as they do unless they were joined otherwise, nothing but the fit is another one.

use std::ops::Range;

use super::{SeparationConstraint, chart::ChartKind};
use crate::paths::{IntersectionPaths, PathPoint, PathSegment};

/// Whose charts there are.
#[derive(Debug)]
pub(crate) struct Laid {
    pub(crate) copy: usize,
    pub(crate) partner: usize,
    pub(crate) kinds: [ChartKind; 2],
    /// Where the partner names the same points.
    pub(crate) mirror: Option<Mirror>,
}

/// What holds for both paths, once path and partner are exchanged.
#[derive(Clone, Debug)]
pub(crate) struct Mirror {
    /// Sides of the inside along the path, and along its partner as far as a region says so.
    pub(crate) sides: (f64, Option<f64>),
    pub(crate) separations: Range<usize>,
}

/// Whether two paths name the same points in the same order, each on its own sheet first.
pub(crate) fn are_mirrored(paths: &IntersectionPaths, copies: [usize; 2]) -> bool {
    let [one, other] = copies.map(|copy| &paths.copies[copy]);
    let mirrored_segment = |a: &PathSegment, b: &PathSegment| (a.own, a.partner) == (b.partner, b.own);
    let mirrored_point = |a: &PathPoint, b: &PathPoint| (&a.own, &a.partner) == (&b.partner, &b.own);
    let [a, b] = [one, other].map(|path| &paths.segments[path.segments.clone()]);
    let [p, q] = [one, other].map(|path| &paths.points[path.points.clone()]);
    one.closed == other.closed
        && (a.len(), p.len()) == (b.len(), q.len())
        && a.iter().zip(b).all(|(a, b)| mirrored_segment(a, b))
        && p.iter().zip(q).all(|(p, q)| mirrored_point(p, q) && p.position == q.position)
}

/// Adds the separations of the partner of the path whose separations these are.
pub(crate) fn part_partner(separations: &mut Vec<SeparationConstraint>, of_path: Range<usize>) {
    for index in of_path {
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
