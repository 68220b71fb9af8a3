//! The passes over a shot, by which corrections of single frames become smooth in time.
//!
//! The first pass repairs each frame by itself. Each further pass spreads what the pass before added over the frames
//! beside it, in directions of the material, and checks the state that results; where that is not clean, it is repaired
//! from there, and the next pass spreads what this added. What the last pass adds stays where it is.
//!
//! A frame of a pass depends on the frames of the pass before within the window of the fade, and on nothing else: the
//! output of a frame is a function of the input within [`NUM_SPREADS`] windows on both sides.

use std::{collections::BTreeMap, sync::Arc};

use nalgebra::Vector3;

use untangle::coherence::{Fade, SparseField, Turns, spread};
use untangled_mesh_io::CacheFrame;

use super::single::{RepairedFrame, Repairer};
use crate::cli::{
    fix::{Blocked, rank},
    input::Input,
    sequence::{
        error::SequenceError,
        pipeline::Window,
        shot::{Judgement, State},
    },
};

/// Passes that spread what the one before added.
pub(super) const NUM_SPREADS: usize = 3;
/// The window: long enough for a smooth motion at 24 frames a second, short beside a shot.
pub(super) const FADE: Fade = Fade { num_frames: 8 };

/// What is known of a frame after a pass.
#[derive(Clone, Debug)]
pub(super) struct Pass {
    /// The correction with which the pass began, in metres.
    start: SparseField,
    /// What the repair of this pass added, in directions of the material.
    added: SparseField,
    /// The vertices that are not where they are in the input, and where they are.
    pub(super) moved: BTreeMap<u32, [f64; 3]>,
    /// The whole correction in directions of the material, after the last pass.
    pub(super) correction: SparseField,
    pub(super) before: Arc<Judgement>,
    pub(super) after: Judgement,
    pub(super) blocked: Vec<Blocked>,
    pub(super) num_iterations: usize,
}

/// A frame as it was read.
struct Read {
    own: CacheFrame,
    state: State,
}

impl Repairer<'_> {
    /// The work of a pass on a frame.
    pub(super) fn pass(&self, number: usize, frame: u64, window: &Window<Pass>) -> Result<Pass, SequenceError> {
        let Some(last) = window.get(&frame) else { return self.first_pass(frame) };
        let fields = window.iter().map(|(&frame, pass)| (frame, &pass.added));
        let carried = spread(frame, fields, FADE);
        if carried.is_empty() {
            let mut pass = Pass { added: SparseField::new(), ..Pass::clone(last) };
            if number == NUM_SPREADS && !pass.moved.is_empty() {
                pass.correction = self.correction(&self.read(frame)?, &pass.moved);
            }
            return Ok(pass);
        }
        self.further_pass(number == NUM_SPREADS, frame, last, &carried)
    }

    fn read(&self, frame: u64) -> Result<Read, SequenceError> {
        let (own, roles) = self.shot.read(frame)?;
        let state = self.shot.state(frame, &roles, own.positions())?;
        Ok(Read { own, state })
    }

    fn first_pass(&self, frame: u64) -> Result<Pass, SequenceError> {
        let read = self.read(frame)?;
        let before = Arc::new(self.shot.judge(frame, &read.state)?);
        let mut pass = Pass {
            start: SparseField::new(),
            added: SparseField::new(),
            moved: BTreeMap::new(),
            correction: SparseField::new(),
            after: Judgement::clone(&before),
            before,
            blocked: Vec::new(),
            num_iterations: 0,
        };
        if !pass.before.is_clean() {
            let repaired = self.repair(frame, &read.own, &read.state, &pass.before)?;
            pass.end_at(read.own.positions(), repaired);
            pass.added = self.correction(&read, &pass.moved);
        }
        Ok(pass)
    }

    fn further_pass(
        &self,
        is_last: bool,
        frame: u64,
        last: &Pass,
        carried: &SparseField,
    ) -> Result<Pass, SequenceError> {
        let read = self.read(frame)?;
        let positions = read.own.positions();
        let mut pass = Pass { added: SparseField::new(), blocked: Vec::new(), ..last.clone() };
        for (vertex, vector) in self.in_frame(&read, carried) {
            *pass.start.entry(vertex).or_insert_with(Vector3::zeros) += vector;
        }
        let mut shifted = positions.to_vec();
        for (&vertex, vector) in &pass.start {
            let place = &mut shifted[vertex as usize];
            *place = std::array::from_fn(|axis| place[axis] + vector[axis]);
        }
        let shifted = read.own.stored_positions(&shifted).map_err(|source| self.shot.failed(frame, source))?;
        let state = self.shot.state(frame, &read.state.roles, &shifted)?;
        let found = self.shot.judge(frame, &state)?;
        if found.is_clean() {
            let repaired = RepairedFrame { positions: shifted, found, blocked: Vec::new(), num_iterations: 0 };
            pass.end_at(positions, repaired);
        } else {
            let repaired = self.repair(frame, &read.own, &state, &found)?;
            let repaired = if is_last { self.or_by_itself(frame, &read, &pass, repaired)? } else { repaired };
            let from = |vertex: u32| Vector3::from(shifted[vertex as usize]);
            let places = moved(&shifted, &repaired.positions);
            let added = places.iter().map(|(&vertex, place)| (vertex, Vector3::from(*place) - from(vertex))).collect();
            pass.end_at(positions, repaired);
            pass.added = self.material(&read, &added);
        }
        if is_last {
            pass.correction = self.correction(&read, &pass.moved);
        }
        Ok(pass)
    }

    /// The correction of a frame whose vertices are at places, in directions of the material.
    pub(super) fn correction_of(&self, frame: u64, places: &[[f64; 3]]) -> Result<SparseField, SequenceError> {
        let own = self.shot.cache.read(frame)?;
        let moved = moved(own.positions(), places);
        if moved.is_empty() { Ok(SparseField::new()) } else { Ok(self.correction(&self.read(frame)?, &moved)) }
    }

    /// The repair from the carried corrections, or, where that is not clean, of the frame by itself, if that is better.
    fn or_by_itself(
        &self,
        frame: u64,
        Read { own, state }: &Read,
        pass: &Pass,
        repaired: RepairedFrame,
    ) -> Result<RepairedFrame, SequenceError> {
        if repaired.found.is_clean() {
            return Ok(repaired);
        }
        let alone = if pass.before.is_clean() {
            let (positions, found) = (own.positions().to_vec(), Judgement::clone(&pass.before));
            RepairedFrame { positions, found, blocked: Vec::new(), num_iterations: 0 }
        } else {
            self.repair(frame, own, state, &pass.before)?
        };
        let rank = |of: &RepairedFrame| (!of.found.is_clean(), rank(&of.found.counts));
        Ok(if rank(&alone) < rank(&repaired) { alone } else { repaired })
    }

    /// The correction that takes the input to places, in directions of the material.
    fn correction(&self, read: &Read, places: &BTreeMap<u32, [f64; 3]>) -> SparseField {
        let positions = read.own.positions();
        let from = |vertex: u32| Vector3::from(positions[vertex as usize]);
        let field = places.iter().map(|(&vertex, place)| (vertex, Vector3::from(*place) - from(vertex)));
        self.material(read, &field.collect())
    }

    /// Displacements of a frame in directions of the material.
    fn material(&self, read: &Read, displacements: &SparseField) -> SparseField {
        let Input { weld, mesh, frame, .. } = &read.state.input;
        let reference = weld.gather(&self.shot.reference);
        let turns = Turns::new(mesh, &reference, frame);
        displacements.iter().map(|(&vertex, vector)| (vertex, turns.to_material(weld.of(vertex), *vector))).collect()
    }

    /// A field of the material in the directions of a frame. Vertices that are welded get the same.
    fn in_frame(&self, read: &Read, field: &SparseField) -> SparseField {
        let Input { weld, mesh, frame, .. } = &read.state.input;
        let reference = weld.gather(&self.shot.reference);
        let turns = Turns::new(mesh, &reference, frame);
        let mut turned = SparseField::new();
        for (&vertex, vector) in field {
            let welded = weld.of(vertex);
            if mesh.is_pinned(welded) || turned.contains_key(&vertex) {
                continue;
            }
            let vector = turns.to_frame(welded, *vector);
            turned.extend(weld.copies(welded).iter().map(|&copy| (copy, vector)));
        }
        turned
    }
}

impl Pass {
    /// Takes a state as the result of the pass.
    fn end_at(&mut self, input: &[[f64; 3]], repaired: RepairedFrame) {
        let RepairedFrame { positions, found, blocked, num_iterations } = repaired;
        self.moved = moved(input, &positions);
        self.after = found;
        self.blocked = blocked;
        self.num_iterations += num_iterations;
    }
}

/// The vertices whose bits differ, and where they are.
pub(super) fn moved(before: &[[f64; 3]], after: &[[f64; 3]]) -> BTreeMap<u32, [f64; 3]> {
    let pairs = (0..).zip(before.iter().zip(after));
    let is_moved = |(before, after): (&[f64; 3], &[f64; 3])| before.map(f64::to_bits) != after.map(f64::to_bits);
    pairs.filter(|(_, pair)| is_moved(*pair)).map(|(vertex, (_, after))| (vertex, *after)).collect()
}
