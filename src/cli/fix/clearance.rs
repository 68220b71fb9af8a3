//! The gap: what nothing intersects is set apart, written, read back and judged; again where rounding in the file took
//! some of the gap.

use std::{ops::ControlFlow, sync::atomic::Ordering};

use untangle::relax::{Clearance, InfeasiblePlace, Iteration, RelaxSettings, open_gap};

use crate::cli::{
    gap::{Asked, GapCertificate, GapReport, InfeasibleReport},
    input::Input,
    owners::Owners,
};

use super::{
    error::FixError,
    plan::check_movable,
    repair::{Repair, Repaired, Store, Written, rank},
    terminal::{Interrupt, Progress},
};

/// Most rounds, each of which opens the gap of what was read back from the files of the last one.
const MOST_ROUNDS: usize = 4;

/// What does not change between rounds.
pub(in crate::cli) struct Clearing<'a> {
    pub(in crate::cli) repair: &'a Repair<'a>,
    /// The gap, if one was asked for.
    pub(in crate::cli) asked: Option<Asked>,
    /// The input.
    pub(in crate::cli) input: &'a Input,
    pub(in crate::cli) owners: &'a Owners<'a>,
}

impl Clearing<'_> {
    /// Opens the gap of a state, but beside what is left tangled. Gives back the state, and its distances if a gap was
    /// asked for.
    pub(in crate::cli) fn run(
        &self,
        mut repaired: Repaired,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<(Repaired, Option<GapReport>), FixError> {
        let Some(asked) = &self.asked else { return Ok((repaired, None)) };
        progress.say("measuring distances");
        let before = GapReport::of(asked, self.input, self.owners)?;
        let (certificate, places) = self.rounds(asked.distance_m, &mut repaired, interrupt, progress)?;
        interrupt.check()?;
        let weld = &self.input.weld;
        let infeasible = places.iter().map(|place| InfeasibleReport::new(place, weld, self.owners)).collect();
        let gap = GapReport {
            num_pairs_below_before: Some(before.num_pairs_below),
            certificate: Some(certificate),
            infeasible: Some(if certificate.is_kept() { Vec::new() } else { infeasible }),
            ..GapReport::of(asked, &repaired.written.input, self.owners)?
        };
        Ok((repaired, Some(gap)))
    }

    /// Opens the gap until a judge finds it kept, or that does not help any more. Gives back what the judge found last,
    /// and where pairs are left.
    fn rounds(
        &self,
        distance_m: f64,
        repaired: &mut Repaired,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<(GapCertificate, Vec<InfeasiblePlace>), FixError> {
        let judge =
            |written: &Written| GapCertificate::of(self.repair.files, self.repair.roles, &written.input, distance_m);
        let mut certificate = judge(&repaired.written);
        let mut places: Vec<InfeasiblePlace> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let max_iterations = self.repair.settings.max_iterations.saturating_sub(repaired.history.len());
            let is_over = repaired.time_limit_reached || max_iterations == 0;
            if certificate.is_kept() || is_over {
                break;
            }
            if let Store::Files(jobs) = self.repair.store {
                check_movable(jobs, self.input)?;
            }
            progress.say("setting primitives apart");
            let settings = RelaxSettings { max_iterations, ..self.repair.settings.clone() };
            let (written, clearance) = self.round(&repaired.written, distance_m, &settings, interrupt, progress)?;
            let next = judge(&written);
            repaired.time_limit_reached |= clearance.interrupted;
            repaired.history.extend(clearance.history);
            if places.is_empty() || next.total() < certificate.total() {
                places = clearance.infeasible;
            }
            if rank(&written.counts) > rank(&repaired.written.counts) || next.total() >= certificate.total() {
                break;
            }
            (repaired.written, certificate) = (written, next);
            if !places.is_empty() {
                break;
            }
        }
        Ok((certificate, places))
    }

    /// Opens the gap of a state once and writes it.
    fn round(
        &self,
        start: &Written,
        distance_m: f64,
        settings: &RelaxSettings,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<(Written, Clearance), FixError> {
        let Input { weld, mesh, positions, .. } = &start.input;
        let asked = interrupt.flag();
        let should_stop = || asked.load(Ordering::Relaxed) || self.repair.is_late();
        let mut after_iteration = |iteration: &Iteration| {
            progress.iteration(iteration);
            if should_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let welded = weld.gather(positions);
        let clearance = open_gap(mesh, &welded, distance_m, settings, &mut after_iteration, &should_stop)
            .map_err(FixError::Relax)?;
        interrupt.check()?;
        progress.say("checking what is written");
        let written = self.repair.write(&start.input, &weld.scatter(positions, &clearance.positions), interrupt)?;
        Ok((written, clearance))
    }
}
