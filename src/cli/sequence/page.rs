//! `--html` of sequences: frames are recorded as they are done, and written as a page at the end,
//! when the result is at its place and was said.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use untangle::analysis::Analysis;

use super::{
    error::SequenceError,
    shot::{Shot, State},
};
use crate::cli::{
    fix::{FixError, Interrupt, Target},
    html::{FrameRecorder, MOST_COORDINATES, MeshData, PageData, Setting, page_target},
    outcome,
};

/// A page under way.
#[derive(Debug)]
pub(super) struct ShotPage {
    target: Target,
    recorder: FrameRecorder,
    /// What is said to people, for the summary.
    words: String,
}

impl ShotPage {
    /// For frames that have states of these names. The page may not replace `inputs`.
    pub(super) fn new(
        shot: &Shot,
        names: &'static [&'static str],
        path: &Path,
        inputs: &[&Path],
        overwrite: bool,
    ) -> Result<Self, SequenceError> {
        let target = page_target(path, inputs, overwrite)?;
        let num_frames = shot.part.end() - shot.part.start() + 1;
        let coordinates = num_frames.saturating_mul(3 * shot.reference.len() as u64);
        if coordinates > MOST_COORDINATES {
            let reason = format!(
                "would hold {coordinates} coordinates, and a page takes {MOST_COORDINATES}; --frames A..B gives a part"
            );
            return Err(FixError::Target { path: target.path, reason }.into());
        }
        Ok(Self { target, recorder: FrameRecorder::new(names), words: String::new() })
    }

    /// Where it goes.
    pub(super) fn target(&self) -> &Target {
        &self.target
    }

    /// Takes the states of the next frame and its line. `words` are those for people.
    pub(super) fn push(&mut self, frame: u64, line: Value, words: &str, states: &[(&State, &Analysis)]) {
        self.words.push_str(words);
        let states: Vec<_> = states.iter().map(|(state, analysis)| (&state.input, *analysis)).collect();
        self.recorder.push(frame, line, &states);
    }

    /// Adds to the words of the summary.
    pub(super) fn say(&mut self, words: &str) {
        self.words.push_str(words);
    }

    /// Writes the page. `command` is its name and its arguments.
    pub(super) fn write(
        self,
        shot: &Shot,
        (command, settings): (&'static str, Vec<Setting>),
        totals: &impl Serialize,
        interrupt: &Interrupt,
    ) -> Result<(), SequenceError> {
        let Self { target, recorder, words } = self;
        let (centre, states, frames) = recorder.finish();
        let mesh = MeshData::with_centre(&shot.files, &shot.roles, centre, &shot.pins);
        let mut page = PageData::new(command, outcome::printable(&words), totals, mesh);
        page.settings = settings;
        page.states = states;
        page.sequence = Some(frames);
        Ok(page.write(&target, interrupt)?)
    }
}
