//! Other attempts, where the first one ended far from the input: of all ends the one that costs least is kept.
//!
//! Which of several motions an attempt takes is chance where they are about as good. With the least of several
//! attempts, each of which goes in another way, it is far less so. An end is at rest only as seen from where its
//! attempt came: cloth that is led back a part of the way, intersects anew and is resolved anew, often ends nearer.
//!
//! | file | purpose |
//! |---|---|
//! | `ends` | clean ends of attempts, and what each costs |
//! | `ways` | other attempts, and where each ends |
//! | `layered` | an attempt with the order in which most of each piece lies |
//!
//! A row uses those above it only.

mod ends;
mod layered;
mod ways;

use nalgebra::Point3;
use rayon::prelude::*;

use super::{
    escape::DescentVariant,
    outcome::{Method, RelaxError},
    plan::{Largest, is_beyond_trials},
    relaxer::Relaxer,
    settings::Effort,
};
pub(super) use ends::CleanEnd;
use ends::{Measure, mean_displacement};
pub(super) use layered::{LayeredAttempt, LayeredEnd, attempt_in_implied_order};
use ways::Way;

/// A state is near the input where its vertices moved by no more than this part of the diagonal, on the average.
const NEAR: f64 = 0.005;
/// The same for large tangles, of which each attempt takes long.
const NEAR_OF_LARGE: f64 = 0.02;
/// An end is taken over an earlier one only where it costs less than this part of it: near ties are none.
const CLEARLY_LESS: f64 = 0.99;
/// The parts of the way to the best end from which attempts begin again.
const PARTS: [f64; 3] = [0.5, 0.75, 0.9];
/// How often that is done, as long as each time takes away so much of what it costs.
const MAX_ROUNDS: usize = 3;
const MIN_GAIN: f64 = 0.05;

/// Whether there is time for other attempts, and a choice: those of the largest tangles take too long, and bodies and
/// layers say who belongs where.
pub(super) fn are_allowed(relaxer: &Relaxer<'_>, largest: Largest) -> bool {
    let is_asked = relaxer.settings.other_attempts && relaxer.settings.effort != Effort::Fast;
    is_asked && relaxer.sides.is_none() && !largest.is_crowded() && !is_beyond_trials(largest.num_edge_face)
}

/// Whether the present state, a clean one, is far from the input. Where that took straightening, no motion is short.
pub(super) fn is_far(relaxer: &Relaxer<'_>, largest: Largest) -> bool {
    let near = if largest.is_large() { NEAR_OF_LARGE } else { NEAR };
    let is_straightened = relaxer.history.iter().any(|step| step.method == Method::Flatten);
    !is_straightened && mean_displacement(relaxer) > near
}

/// Whether an end is near the input beside what straightening leaves.
pub(super) fn is_near(end: &CleanEnd) -> bool {
    end.mean() <= NEAR_OF_LARGE
}

/// Goes over to another end where the present state is not clean, or moves or strains more. True if it did.
pub(super) fn take_if_nearer(
    relaxer: &mut Relaxer<'_>,
    LayeredEnd { end: other, .. }: LayeredEnd,
    is_clean: bool,
) -> Result<bool, RelaxError> {
    let is_nearer = !is_clean || other.is_no_loss_beside(&CleanEnd::of(relaxer));
    if is_nearer {
        take(relaxer, other)?;
    }
    Ok(is_nearer)
}

/// Where the first descent ends from where a coarser mesh came apart; nothing where that is not clean.
///
/// Cost: that of an attempt from a state that is hardly tangled.
pub(super) fn end_from_coarser(
    relaxer: &Relaxer<'_>,
    largest: Largest,
    state: &[Point3<f64>],
) -> Result<Option<CleanEnd>, RelaxError> {
    Way::Coarser(state).end(relaxer, largest)
}

/// Goes over to an end, led back where it is far from the input, or strains an edge or a face beyond the limits.
pub(super) fn take_led_back(relaxer: &mut Relaxer<'_>, largest: Largest, end: CleanEnd) -> Result<(), RelaxError> {
    if is_near(&end) && !end.is_beyond_limits() {
        return take(relaxer, end);
    }
    take_nearest(relaxer, largest, vec![end]).map(|_| ())
}

/// Makes the other attempts, side by side, and goes over to the end that costs least; `is_clean` says whether the
/// present state is one of those: then no end counts that moves or strains more. True where the state that it leaves is
/// clean.
///
/// Cost: that of two attempts by trials and up to nine that are led back; where nothing has come clean, of two descents
/// as well, but in large tangles, where they take long.
pub(super) fn take_least(relaxer: &mut Relaxer<'_>, largest: Largest, is_clean: bool) -> Result<bool, RelaxError> {
    let mut others = ends(relaxer, largest, &Way::TRIALS)?;
    // Descents take ten times as long as trials, and beside a clean end theirs are hardly ever nearer.
    if !is_clean && others.is_empty() && !largest.is_large() {
        others = ends(relaxer, largest, &DescentVariant::OTHERS.map(Way::Descent))?;
    }
    let first = is_clean.then(|| CleanEnd::of(relaxer));
    let is_candidate = |end: &CleanEnd| first.as_ref().is_none_or(|first| end.is_no_loss_beside(first));
    let others: Vec<CleanEnd> = others.into_iter().filter(is_candidate).collect();
    let ends: Vec<CleanEnd> = first.into_iter().chain(others).collect();
    Ok(take_nearest(relaxer, largest, ends)? || is_clean)
}

/// Goes over to the end that costs least, led back. False without any.
fn take_nearest(relaxer: &mut Relaxer<'_>, largest: Largest, ends: Vec<CleanEnd>) -> Result<bool, RelaxError> {
    let Some(measure) = Measure::of(relaxer, &ends) else { return Ok(false) };
    let Some(end) = least(relaxer, &measure, ends) else { return Ok(false) };
    let end = nearest(relaxer, largest, &measure, end)?;
    take(relaxer, end)?;
    Ok(true)
}

/// Goes over to an end.
pub(super) fn take(relaxer: &mut Relaxer<'_>, end: CleanEnd) -> Result<(), RelaxError> {
    relaxer.set_frame(&end.positions)?;
    relaxer.history = end.history;
    Ok(())
}

/// The end of attempts from parts of the way to an end that costs least, or that end.
fn nearest(
    relaxer: &Relaxer<'_>,
    largest: Largest,
    measure: &Measure,
    (mut end, mut cost): (CleanEnd, f64),
) -> Result<CleanEnd, RelaxError> {
    for _ in 0..MAX_ROUNDS {
        let before = cost;
        let nearer = ends(relaxer, largest, &PARTS.map(|part| Way::Part(&end, part)))?;
        let nearer: Vec<CleanEnd> = nearer.into_iter().filter(|nearer| nearer.is_no_loss_beside(&end)).collect();
        if let Some(found) = least(relaxer, measure, nearer)
            && found.1 < CLEARLY_LESS * cost
        {
            (end, cost) = found;
        }
        if cost > (1.0 - MIN_GAIN) * before {
            break;
        }
    }
    Ok(end)
}

/// The clean ends of attempts, in their order.
fn ends(relaxer: &Relaxer<'_>, largest: Largest, ways: &[Way<'_>]) -> Result<Vec<CleanEnd>, RelaxError> {
    let ends = ways.par_iter().map(|way| way.end(relaxer, largest));
    let ends: Vec<Option<CleanEnd>> = ends.collect::<Result<_, RelaxError>>()?;
    Ok(ends.into_iter().flatten().collect())
}

/// The end that costs least, the first of near ties, and what it costs.
fn least(relaxer: &Relaxer<'_>, measure: &Measure, ends: Vec<CleanEnd>) -> Option<(CleanEnd, f64)> {
    let mut least: Option<(CleanEnd, f64)> = None;
    for end in ends {
        let cost = measure.cost(relaxer, &end);
        if least.as_ref().is_none_or(|(_, least)| cost < CLEARLY_LESS * least) {
            least = Some((end, cost));
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use std::slice;

    use nalgebra::Point3;

    use super::*;
    use crate::{
        mesh::Mesh,
        relax::{escape::tests::samples::Pieces, settings::RelaxSettings},
    };

    /// What there is to know of an input with one path.
    fn largest(relaxer: &Relaxer<'_>) -> Largest {
        let num_edge_face = relaxer.analyser.last().intersections.edge_face.len();
        Largest { num_edge_face, num_pairs: 1, flattenable: 1.0, is_copy: false }
    }

    /// The costs of the end of the first attempt and of the least of all ends, and where that is.
    fn costs(mesh: &Mesh, input: &[[f64; 3]]) -> ([f64; 2], Vec<Point3<f64>>) {
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(mesh, input, &settings, &|| false).unwrap();
        relaxer.analyse();
        let largest = largest(&relaxer);
        let first = [Way::Descent(DescentVariant::FIRST).end(&relaxer, largest).unwrap().unwrap()];
        relaxer.set_frame(&first[0].positions).unwrap();
        assert!(take_least(&mut relaxer, largest, true).unwrap());
        assert!(relaxer.is_clean());
        let measure = Measure::of(&relaxer, &first).unwrap();
        let end = CleanEnd::of(&relaxer);
        assert!(end.is_no_loss_beside(&first[0]));
        let costs = [&first[0], &end].map(|end| measure.cost(&relaxer, end));
        (costs, end.positions)
    }

    #[test]
    fn least_of_all_ends_costs_less_than_the_first_in_the_same_bytes_on_one_or_three_threads() {
        let pieces = Pieces::finger(12);
        let (mesh, _) = pieces.mesh();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| costs(&mesh, &pieces.positions))
        };
        let ([first, least], positions) = on(1);
        println!("{first} {least}");
        assert!(least < first);
        assert_eq!(on(3).1, positions);
    }

    #[test]
    fn end_that_is_led_back_and_resolved_anew_costs_less() {
        let settings = RelaxSettings::default();
        let pieces = Pieces::finger(12);
        let (mesh, _) = pieces.mesh();
        let mut relaxer = Relaxer::new(&mesh, &pieces.positions, &settings, &|| false).unwrap();
        relaxer.analyse();
        let largest = largest(&relaxer);
        let first = Way::Descent(DescentVariant::FIRST).end(&relaxer, largest).unwrap().unwrap();
        let measure = Measure::of(&relaxer, slice::from_ref(&first)).unwrap();
        let before = measure.cost(&relaxer, &first);
        let end = nearest(&relaxer, largest, &measure, (first, before)).unwrap();
        let after = measure.cost(&relaxer, &end);
        println!("{before} {after}");
        assert!(after < (1.0 - MIN_GAIN) * before);
        relaxer.set_frame(&end.positions).unwrap();
        assert!(relaxer.is_clean());
    }
}
