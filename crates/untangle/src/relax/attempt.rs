//! One attempt from the input: a descent by local motions, then what may help where that ends stuck.

use super::{
    constraints::Objective,
    escape::{DescentVariant, descend},
    nudge::nudge,
    outcome::{BestState, End, RelaxError},
    plan::{Pace, StallCriterion},
    relaxer::{Progress, Relaxer},
    resolve::resolve,
    step::are_faces_pinned,
};
use crate::intersect::Segment;

/// Whether most of what intersects meets pinned faces: a body that stays. The shortest motion out of it may lead
/// through it, while the regions of the paths show on which side the cloth belongs. A mesh with bodies knows
/// that of them.
fn is_against_pins(relaxer: &Relaxer<'_>) -> bool {
    if relaxer.sides.is_some() {
        return false;
    }
    let segments = &relaxer.analyser.last().intersections.segments;
    let meets_pins = |segment: &&Segment| segment.faces.iter().any(|&face| are_faces_pinned(relaxer.mesh, [face]));
    2 * segments.iter().filter(meets_pins).count() > segments.len()
}

/// A descent from the present state, which is the input, then trials from where it ends stuck, and single vertices from
/// where these do. Against a body that stays trials come first. `largest` is the number of edge-face intersections of
/// the island that has most.
pub(super) fn attempt(
    relaxer: &mut Relaxer<'_>,
    largest: usize,
    variant: DescentVariant,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    let stall = StallCriterion::with(largest, Pace::Usual);
    if is_against_pins(relaxer) {
        let input = relaxer.frame.positions().to_vec();
        let end = resolve(relaxer, Objective::Normal, Pace::Usual, stall, best, progress)?;
        if end != End::Stuck {
            return Ok(end);
        }
        relaxer.set_frame(&input)?;
    }
    let mut end = descend(relaxer, variant, best, progress)?;
    if end == End::Stuck && relaxer.sides.is_some() {
        relaxer.set_frame(&best.positions)?;
        if relaxer.hangs_on_pins() {
            // Nothing else waits for it, or goes without recovery.
            return Ok(End::Clean);
        }
    }
    for objective in [Objective::Normal, Objective::Target] {
        if end == End::Stuck {
            relaxer.set_frame(&best.positions)?;
            end = resolve(relaxer, objective, Pace::Usual, stall, best, progress)?;
        }
        if relaxer.is_on_wrong_side_only() {
            return Ok(end);
        }
    }
    if end == End::Stuck { nudge(relaxer, best, progress) } else { Ok(end) }
}
