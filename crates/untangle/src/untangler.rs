//! All stages of one frame over one mesh: analysis, then response.

use std::sync::Arc;

use crate::{
    analysis::{Analyser, Analysis},
    correspond::Correspondences,
    frame::Frame,
    intersect::SearchEnd,
    mesh::Mesh,
    relax::{AnalysedFrame, Proposer},
    respond::{Corrections, Responder},
    settings::{Response, Settings, SettingsError},
    stage::{Stage, StageObserver},
};

/// Untangles frames of one mesh. It keeps memory and caches from frame to frame, but no history: the answer depends on
/// the mesh, the frame and the settings alone.
#[derive(Debug)]
pub struct Untangler {
    mesh: Arc<Mesh>,
    settings: Settings,
    analyser: Analyser,
    responder: Responder,
    proposer: Proposer,
    is_single_precision: bool,
    is_displaced: bool,
}

/// The answer to one frame.
#[derive(Clone, Copy, Debug)]
pub struct Outcome<'a> {
    /// How the search for intersections ended. Unless it is complete, nothing is known of the frame, and analysis and
    /// corrections are empty.
    pub search: SearchEnd,
    /// The global intersection analysis.
    pub analysis: &'a Analysis,
    /// Targets of the points inside; empty where the response needs none.
    pub correspondences: &'a Correspondences,
    /// The corrections.
    pub corrections: &'a Corrections,
}

impl Untangler {
    /// An untangler for one mesh.
    ///
    /// # Errors
    /// [`SettingsError`] for a setting that can't be used.
    pub fn new(mesh: Arc<Mesh>, settings: Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        Ok(Self {
            mesh,
            settings,
            analyser: Analyser::default(),
            responder: Responder::default(),
            proposer: Proposer::default(),
            is_single_precision: false,
            is_displaced: true,
        })
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings from the next frame on.
    ///
    /// # Errors
    /// [`SettingsError`]; the old settings stay in force then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), SettingsError> {
        settings.validate()?;
        self.settings = settings;
        Ok(())
    }

    /// Switches the labels of [`Corrections`] on or off, from the next frame on; they are off at first.
    pub fn set_labelled(&mut self, is_labelled: bool) {
        self.responder.set_labelled(is_labelled);
    }

    /// Whether [`Corrections`] have labels.
    #[must_use]
    pub fn is_labelled(&self) -> bool {
        self.responder.is_labelled()
    }

    /// Says that the host adds displacements in single precision, from the next frame on; in double precision at first.
    /// What the responses `displacement` and `coupled` lead to is judged at the positions that the host will have.
    pub fn set_single_precision(&mut self, is_single_precision: bool) {
        self.is_single_precision = is_single_precision;
    }

    /// Whether the host adds displacements in single precision.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        self.is_single_precision
    }

    /// Says whether the host adds the values of the responses `displacement` and `coupled` to its positions before its
    /// next step, from the next frame on; it does at first. Where it does, and nothing intersects there any more, it
    /// gets neither mask nor labels, so that its contact holds what was won; a host that takes forces or velocities
    /// instead has to get there first.
    pub fn set_displaced(&mut self, is_displaced: bool) {
        self.is_displaced = is_displaced;
    }

    /// Whether the host adds displacements to its positions.
    #[must_use]
    pub fn is_displaced(&self) -> bool {
        self.is_displaced
    }

    /// Analyses one frame and computes its corrections.
    pub fn process(&mut self, frame: &Frame, observer: &mut dyn StageObserver) -> Outcome<'_> {
        self.analyser.analyse(&self.mesh, frame, &self.settings, observer);
        let analysis = self.analyser.last();
        self.responder.respond(&self.mesh, frame, analysis, &self.settings, observer);
        if matches!(self.settings.response, Response::Displacement | Response::Coupled) {
            observer.begin(Stage::Respond);
            let Self { mesh, settings, is_single_precision: is_single, is_displaced, .. } = self;
            let (is_single, is_displaced) = (*is_single, *is_displaced);
            let view = AnalysedFrame { mesh, frame, analysis, settings, is_single, is_displaced };
            self.proposer.propose(&view, &mut self.responder, observer);
            observer.end();
        }
        self.last()
    }

    /// The outcome of the last frame that was processed; an empty one before the first.
    #[must_use]
    pub fn last(&self) -> Outcome<'_> {
        Outcome {
            search: self.analyser.search_end(),
            analysis: self.analyser.last(),
            correspondences: self.responder.correspondences(),
            corrections: self.responder.corrections(),
        }
    }
}
