//! The repair of one state of one frame: what `fix` does of a file, in memory.

use untangle::relax::{Effort, RelaxSettings, relax_until};
use untangled_mesh_io::CacheFrame;

use crate::cli::{
    fix::{Blocked, Clearing, FixError, Interrupt, Progress, Repair, Repaired, Store},
    gap::GapReport,
    owners::Owners,
    sequence::{
        error::SequenceError,
        shot::{Judgement, Shot, State},
    },
};

/// How frames are repaired.
pub(super) struct Repairer<'a> {
    pub(super) shot: &'a Shot,
    pub(super) effort: Effort,
    pub(super) max_iterations: usize,
    pub(super) interrupt: &'a Interrupt,
}

/// A repaired state.
pub(super) struct RepairedFrame {
    /// Positions of the cloth as the frame holds them.
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) found: Judgement,
    pub(super) blocked: Vec<Blocked>,
    pub(super) num_iterations: usize,
}

impl Judgement {
    /// Whether no reader finds anything.
    pub(super) fn is_clean(&self) -> bool {
        self.counts.is_certified() && self.gap.as_ref().is_none_or(GapReport::is_kept)
    }
}

impl Repairer<'_> {
    /// Repairs a state of a frame, in which there is what `before` says.
    pub(super) fn repair(
        &self,
        frame: u64,
        own: &CacheFrame,
        state: &State,
        before: &Judgement,
    ) -> Result<RepairedFrame, SequenceError> {
        let shot = self.shot;
        self.repair_state(own, state, before).map_err(|source| match source {
            FixError::Store(source) => shot.failed(frame, source),
            source => {
                let source = Box::new(source);
                SequenceError::FrameFix { path: shot.cache.file(frame), frame, source }
            }
        })
    }

    fn repair_state(&self, own: &CacheFrame, state: &State, before: &Judgement) -> Result<RepairedFrame, FixError> {
        let State { files, roles, input } = state;
        let Self { shot, effort, max_iterations, interrupt } = self;
        let settings = RelaxSettings {
            effort: *effort,
            max_iterations: *max_iterations,
            single_precision: own.is_single_precision(),
            // A shot has hundreds of frames.
            other_attempts: false,
        };
        let repair = Repair { files, roles, store: Store::Frame(own), pins: &shot.pins, settings, deadline: None };
        let mut progress = Progress::silent();
        let repaired = if before.counts.is_certified() {
            Repaired::unchanged(repair.write(input, &input.positions, interrupt)?)
        } else {
            repair.run(input, &before.counts, &mut relax_until, interrupt, &mut progress)?
        };
        let owners = Owners::new(files.iter().chain(&roles.bodies));
        let clearing = Clearing { repair: &repair, asked: shot.gap.clone(), input, owners: &owners };
        let (Repaired { written, history, mut blocked, .. }, gap) = clearing.run(repaired, interrupt, &mut progress)?;
        Blocked::name_owners(&mut blocked, &owners);
        let num_zeroed_coordinates = written.input.num_zeroed_coordinates();
        let mut positions = written.input.positions;
        positions.truncate(own.positions().len());
        Ok(RepairedFrame {
            positions,
            found: Judgement { counts: written.counts, gap, num_zeroed_coordinates },
            blocked,
            num_iterations: history.len(),
        })
    }
}
