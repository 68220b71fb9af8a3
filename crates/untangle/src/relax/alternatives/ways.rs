//! Other attempts, and where each ends.

use std::ops::ControlFlow;

use nalgebra::Point3;

use super::ends::CleanEnd;
use crate::{
    mesh::Mesh,
    relax::{
        attempt::attempt,
        constraints::Objective,
        escape::DescentVariant,
        outcome::{BestState, End, Iteration, RelaxError},
        plan::{Largest, Pace, StallCriterion},
        relaxer::{Progress, Relaxer},
        resolve::resolve,
        settle::settle,
        step::stored,
    },
};

/// How another attempt goes.
#[derive(Clone, Copy)]
pub(super) enum Way<'a> {
    /// Trials from the input, with this objective first.
    Trials(Objective),
    /// Another descent from the input.
    Descent(DescentVariant),
    /// The first descent, from this part of the way to an end.
    Part(&'a CleanEnd, f64),
    /// The first descent, from where a coarser mesh came apart.
    Coarser(&'a [Point3<f64>]),
    /// The first descent from the input, of the same mesh with layers.
    Layered(&'a Mesh),
}

impl Way<'_> {
    /// Trials: least displacements from the input, so that most of the shortest ends of all are theirs.
    pub(super) const TRIALS: [Self; 2] = [Self::Trials(Objective::Normal), Self::Trials(Objective::Target)];

    /// Where the attempt ends that goes so; nothing where that is not clean. `first` has the input, and what the first
    /// attempt knows of it.
    ///
    /// Cost: that of an attempt and of shape recovery.
    pub(super) fn end(self, first: &Relaxer<'_>, largest: Largest) -> Result<Option<CleanEnd>, RelaxError> {
        let mut progress = |_: &Iteration| ControlFlow::Continue(());
        Ok(match self.run(first, largest, &mut progress)? {
            WayEnd::Clean(end) => Some(end),
            WayEnd::Interrupted(..) | WayEnd::Stuck => None,
        })
    }

    /// The same with an end that the caller may bring about.
    pub(super) fn run(
        self,
        first: &Relaxer<'_>,
        largest: Largest,
        progress: &mut Progress<'_>,
    ) -> Result<WayEnd, RelaxError> {
        let Relaxer { settings, should_stop, rest, .. } = first;
        let mesh = if let Self::Layered(mesh) = self { mesh } else { first.mesh };
        let input: Vec<[f64; 3]> = rest.positions().iter().map(|&at| at.into()).collect();
        let mut relaxer = Relaxer::new(mesh, &input, settings, *should_stop)?;
        relaxer.first_islands = first.first_islands.clone();
        let mut start = rest.positions().to_vec();
        // What stays keeps its bits, also where single precision does not have them.
        let moved = |at: &mut Point3<f64>, to: Point3<f64>| {
            if to != *at {
                *at = stored(to, settings.single_precision);
            }
        };
        match self {
            Self::Part(end, part) => {
                start.iter_mut().zip(&end.positions).for_each(|(at, end)| moved(at, *at + (end - *at) * part));
            }
            Self::Coarser(state) => start.iter_mut().zip(state).for_each(|(at, to)| moved(at, *to)),
            Self::Trials(_) | Self::Descent(_) | Self::Layered(_) => {}
        }
        relaxer.set_frame(&start)?;
        let mut best = BestState { merit: f64::INFINITY, positions: start };
        let num_edge_face = largest.num_edge_face;
        let how = match self {
            Self::Trials(objective) => {
                let stall = StallCriterion::with(num_edge_face, Pace::Usual);
                resolve(&mut relaxer, objective, Pace::Usual, stall, &mut best, progress)?
            }
            Self::Descent(variant) => attempt(&mut relaxer, num_edge_face, variant, &mut best, progress)?,
            Self::Part(..) | Self::Coarser(_) | Self::Layered(_) => {
                attempt(&mut relaxer, num_edge_face, DescentVariant::FIRST, &mut best, progress)?
            }
        };
        if how == End::Interrupted {
            return Ok(WayEnd::Interrupted(best, relaxer.history));
        }
        if how != End::Clean {
            return Ok(WayEnd::Stuck);
        }
        relaxer.set_frame(&best.positions)?;
        let is_ended = settle(&mut relaxer, progress)?;
        if let Self::Part(end, _) = self {
            relaxer.history.splice(0..0, end.history.iter().copied());
        }
        if is_ended || should_stop() {
            let best = BestState { merit: 0.0, positions: relaxer.frame.positions().to_vec() };
            return Ok(WayEnd::Interrupted(best, relaxer.history));
        }
        Ok(WayEnd::Clean(CleanEnd::of(&relaxer)))
    }
}

/// How an attempt ended.
pub(super) enum WayEnd {
    Clean(CleanEnd),
    /// The caller asked for it; the best state so far, and its history.
    Interrupted(BestState, Vec<Iteration>),
    Stuck,
}
