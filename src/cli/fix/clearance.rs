//! The gap: what nothing intersects is set apart, written, read back and judged; again where rounding in the file took
//! some of the gap.

use std::{ops::ControlFlow, sync::atomic::Ordering};

use untangle::relax::{Clearance, InfeasiblePlace, Iteration, RelaxSettings, open_gap};
use untangled_mesh_io::MeshFile;

use crate::cli::{
    gap::{Asked, GapCertificate, GapReport, InfeasibleReport},
    input::Input,
    owners::Owners,
};

use super::{
    error::FixError,
    plan::check_movable,
    repair::{Repair, Repaired, Written},
    terminal::{Interrupt, Progress},
};

/// Most rounds, each of which opens the gap of what was read back from the files of the last one.
const MOST_ROUNDS: usize = 4;

/// What does not change between rounds.
pub(super) struct Clearing<'a> {
    pub(super) repair: &'a Repair<'a>,
    pub(super) asked: &'a Asked,
    /// The input.
    pub(super) input: &'a Input,
    pub(super) owners: &'a Owners<'a>,
}

impl Clearing<'_> {
    /// Opens the gap of a state that is clean; of another one it only counts. Gives back the state, and its distances.
    pub(super) fn run(
        &self,
        mut repaired: Repaired,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<(Repaired, GapReport), FixError> {
        progress.say("measuring distances");
        let before = GapReport::of(self.asked, self.input, self.owners)?;
        let mut certificate = self.judge(&repaired.written);
        let mut places: Vec<InfeasiblePlace> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let max_iterations = self.repair.settings.max_iterations.saturating_sub(repaired.history.len());
            let is_over = repaired.time_limit_reached || max_iterations == 0;
            if certificate.is_kept() || is_over || !repaired.written.counts.is_certified() {
                break;
            }
            check_movable(self.repair.jobs, self.input)?;
            progress.say("setting primitives apart");
            let (written, clearance) = self.round(&repaired.written, max_iterations, interrupt, progress)?;
            let next = self.judge(&written);
            repaired.time_limit_reached |= clearance.interrupted;
            repaired.history.extend(clearance.history);
            if places.is_empty() || next.total() < certificate.total() {
                places = clearance.infeasible;
            }
            if !written.counts.is_certified() || next.total() >= certificate.total() {
                break;
            }
            (repaired.written, certificate) = (written, next);
            if !places.is_empty() {
                break;
            }
        }
        interrupt.check()?;
        let weld = &self.input.weld;
        let infeasible = places.iter().map(|place| InfeasibleReport::new(place, weld, self.owners)).collect();
        let gap = GapReport {
            num_pairs_below_before: Some(before.num_pairs_below),
            certificate: Some(certificate),
            infeasible: Some(if certificate.is_kept() { Vec::new() } else { infeasible }),
            ..GapReport::of(self.asked, &repaired.written.input, self.owners)?
        };
        Ok((repaired, gap))
    }

    /// Opens the gap of a state once and writes it.
    fn round(
        &self,
        start: &Written,
        max_iterations: usize,
        interrupt: &Interrupt,
        progress: &mut Progress,
    ) -> Result<(Written, Clearance), FixError> {
        let Input { weld, mesh, positions, .. } = &start.input;
        let settings = RelaxSettings { max_iterations, ..self.repair.settings.clone() };
        let asked = interrupt.flag();
        let should_stop = || asked.load(Ordering::Relaxed) || self.repair.is_late();
        let mut after_iteration = |iteration: &Iteration| {
            progress.iteration(iteration);
            if should_stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let welded = weld.gather(positions);
        let distance_m = self.asked.distance_m;
        let clearance = open_gap(mesh, &welded, distance_m, &settings, &mut after_iteration, &should_stop)
            .map_err(FixError::Relax)?;
        interrupt.check()?;
        progress.say("checking what is written");
        let written = self.repair.write(&start.input, &weld.scatter(positions, &clearance.positions), interrupt)?;
        Ok((written, clearance))
    }

    fn judge(&self, written: &Written) -> GapCertificate {
        let files: &[MeshFile] = self.repair.files;
        GapCertificate::of(files, &written.input, self.asked.distance_m)
    }
}
