//! Other attempts from the input, where the first one ended far from it: of all ends the one that costs least is kept.
//!
//! Which of several motions an attempt takes is chance where they are about as good. With the least of several attempts,
//! each of which goes in another way, it is far less so.

use std::ops::ControlFlow;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{
    attempt::attempt,
    energy::Domain,
    escape::DescentVariant,
    outcome::{BestState, End, Iteration, Method, RelaxError},
    plan::Largest,
    relaxer::Relaxer,
    settings::Effort,
    settle::{Pull, settle},
};
use crate::geometry::mean_edge_length;

/// A state is near the input where its vertices moved by no more than this part of the diagonal, on the average.
const NEAR: f64 = 0.005;
/// What came clean in so few iterations did so by the first motions, without a choice.
const MAX_STRAIGHT: usize = 4;
/// An end is taken over an earlier one only where it costs less than this part of it: near ties are none.
const CLEARLY_LESS: f64 = 0.99;

/// A clean end of an attempt, its shape recovered.
struct CleanEnd {
    positions: Vec<Point3<f64>>,
    history: Vec<Iteration>,
    largest_m: f64,
    /// As a part of the diagonal.
    mean: f64,
}

impl CleanEnd {
    fn of(relaxer: &Relaxer<'_>) -> Self {
        let positions = relaxer.frame.positions().to_vec();
        let (largest_m, mean) = (relaxer.largest_displacement_m(), mean_displacement(relaxer));
        Self { positions, history: relaxer.history.clone(), largest_m, mean }
    }

    /// Whether it is as near to the input, on the average and where it is farthest: what costs less energy is no gain
    /// where it moves more.
    fn is_as_near_as(&self, other: &Self) -> bool {
        self.mean <= other.mean && self.largest_m <= other.largest_m
    }
}

/// Whether there is time for other attempts, and a choice: those of large tangles take too long, and bodies and layers
/// say who belongs where.
pub(super) fn are_allowed(relaxer: &Relaxer<'_>, largest: Largest) -> bool {
    let is_asked = relaxer.settings.other_attempts && relaxer.settings.effort != Effort::Fast;
    is_asked && relaxer.sides.is_none() && !largest.is_large()
}

/// Whether the first attempt, whose end is the present state, took a long way and ended far from the input.
pub(super) fn is_far(relaxer: &Relaxer<'_>) -> bool {
    let is_shape_recovery = |step: &&Iteration| step.method == Method::RecoverShape;
    let num_iterations = relaxer.history.iter().filter(|step| !is_shape_recovery(step)).count();
    num_iterations > MAX_STRAIGHT && mean_displacement(relaxer) > NEAR
}

/// The mean distance of vertices from their places in the input, as a part of the diagonal.
fn mean_displacement(relaxer: &Relaxer<'_>) -> f64 {
    let input = relaxer.rest.positions();
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = input.iter().fold(empty, |(low, high), at| (low.inf(&at.coords), high.sup(&at.coords)));
    let moved_m: f64 = relaxer.frame.positions().iter().zip(input).map(|(now, before)| (now - before).norm()).sum();
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let count = input.len() as f64;
    moved_m / (count * (high - low).norm())
}

/// Makes the other attempts, side by side, and goes over to the end that costs least; `is_clean` says whether the
/// present state is one of those: then no end counts that moves more. True where the state that it leaves is clean.
///
/// Cost: that of six attempts.
pub(super) fn take_least(relaxer: &mut Relaxer<'_>, largest: Largest, is_clean: bool) -> Result<bool, RelaxError> {
    let others: Vec<Option<CleanEnd>> = DescentVariant::OTHERS
        .par_iter()
        .map(|&variant| other_end(relaxer, largest, variant))
        .collect::<Result<_, RelaxError>>()?;
    let first = is_clean.then(|| CleanEnd::of(relaxer));
    let is_candidate = |end: &CleanEnd| first.as_ref().is_none_or(|first| end.is_as_near_as(first));
    let others: Vec<CleanEnd> = others.into_iter().flatten().filter(is_candidate).collect();
    let mut ends: Vec<CleanEnd> = first.into_iter().chain(others).collect();
    let Some(measure) = Measure::of(relaxer, &ends) else { return Ok(is_clean) };
    let (mut least, mut chosen) = (f64::INFINITY, None);
    for (index, end) in ends.iter().enumerate() {
        let cost = measure.cost(relaxer, &end.positions);
        if cost < CLEARLY_LESS * least {
            (least, chosen) = (cost, Some(index));
        }
    }
    let Some(chosen) = chosen else { return Ok(is_clean) };
    let CleanEnd { positions, history, .. } = ends.swap_remove(chosen);
    relaxer.history = history;
    relaxer.set_frame(&positions)?;
    Ok(true)
}

/// Where another attempt ends; nothing where that is not clean.
fn other_end(first: &Relaxer<'_>, largest: Largest, variant: DescentVariant) -> Result<Option<CleanEnd>, RelaxError> {
    let Relaxer { mesh, settings, should_stop, rest, .. } = first;
    let input: Vec<[f64; 3]> = rest.positions().iter().map(|&at| at.into()).collect();
    let mut relaxer = Relaxer::new(mesh, &input, settings, *should_stop)?;
    relaxer.first_islands = first.first_islands.clone();
    relaxer.analyse();
    let mut progress = |_: &Iteration| ControlFlow::Continue(());
    let mut best = BestState { merit: f64::INFINITY, positions: rest.positions().to_vec() };
    let end = attempt(&mut relaxer, largest.num_edge_face, variant, &mut best, &mut progress)?;
    if end != End::Clean {
        return Ok(None);
    }
    relaxer.set_frame(&best.positions)?;
    let is_ended = settle(&mut relaxer, &mut progress)?;
    Ok((!is_ended && !should_stop()).then(|| CleanEnd::of(&relaxer)))
}

/// What an end costs: the energy that shape recovery lowers, the same one for all ends.
struct Measure {
    pull: Pull,
    /// All free vertices.
    domain: Domain,
}

impl Measure {
    /// The pull towards the input is that for the end whose farthest vertex is nearest to its place there. Nothing
    /// without ends.
    fn of(relaxer: &Relaxer<'_>, ends: &[CleanEnd]) -> Option<Self> {
        let Relaxer { mesh, frame, .. } = relaxer;
        let largest_m = ends.iter().map(|end| end.largest_m).min_by(f64::total_cmp)?;
        let is_free = |face: &_| mesh.face(*face).iter().any(|&corner| !mesh.is_pinned(corner));
        let edge_m = mean_edge_length(mesh, frame, mesh.face_ids().filter(is_free))?;
        let mut domain = Domain::default();
        domain.grow(mesh, mesh.vertex_ids(), 0);
        Some(Self { pull: Pull::of(largest_m, edge_m), domain })
    }

    fn cost(&self, relaxer: &Relaxer<'_>, positions: &[Point3<f64>]) -> f64 {
        let Relaxer { mesh, frame, rest, .. } = relaxer;
        self.pull.energy(mesh, frame, rest, &self.domain).value(self.pull.stiffness, positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        mesh::Mesh,
        relax::{escape::tests::samples::Pieces, settings::RelaxSettings},
    };

    /// The costs of the end of the first attempt and of the least of all ends, and where that is.
    fn least(mesh: &Mesh, input: &[[f64; 3]]) -> ([f64; 2], Vec<Point3<f64>>) {
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(mesh, input, &settings, &|| false).unwrap();
        relaxer.analyse();
        let num_edge_face = relaxer.analyser.last().intersections.edge_face.len();
        let largest = Largest { num_edge_face, num_pairs: 1, flattenable: 1.0, is_copy: false };
        let first = [other_end(&relaxer, largest, DescentVariant::FIRST).unwrap().unwrap()];
        relaxer.set_frame(&first[0].positions).unwrap();
        assert!(take_least(&mut relaxer, largest, true).unwrap());
        assert!(relaxer.is_clean());
        let measure = Measure::of(&relaxer, &first).unwrap();
        let positions = relaxer.frame.positions().to_vec();
        let costs = [&first[0].positions, &positions].map(|positions| measure.cost(&relaxer, positions));
        (costs, positions)
    }

    #[test]
    fn least_of_all_ends_costs_less_than_the_first_in_the_same_bytes_on_one_or_three_threads() {
        let pieces = Pieces::finger(12);
        let (mesh, _) = pieces.mesh();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| least(&mesh, &pieces.positions))
        };
        let ([first, least], positions) = on(1);
        println!("{first} {least}");
        assert!(least < first);
        assert_eq!(on(3).1, positions);
    }
}
