//! Settings of a session: the same names in files, on the command line and on the wire.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The default of [`Settings::max_step_edge_lengths`].
pub(crate) const DEFAULT_MAX_STEP_EDGE_LENGTHS: f64 = 0.2;

/// All settings of one session. Lengths are in metres where the name says so, otherwise relative to the mean edge
/// length `h` of the faces that a path runs through, so that the defaults fit cloth of any size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How corrections are found.
    pub response: Response,
    /// Which of the two sides of a partitioning path is inside.
    pub inside: InsideChoice,
    /// Whether layers, where the mesh has them, decide instead: a point of an outer layer is inside where it lies
    /// behind a face of an inner layer; the faces of layers are oriented outwards.
    pub layer_order: bool,
    /// Whether winding numbers decide instead on closed, oriented pieces.
    pub winding: bool,
    /// Whether a side that holds pinned vertices is outside, where the other side holds none.
    pub pinned_outside: bool,
    /// Stiffness `k` of the force law, as the part of the distance to the target that one step covers (1/step^2, per
    /// unit mass).
    pub stiffness_per_step2: f64,
    /// Largest correction of a vertex in one step, in `h`: the `f_max` of the force law, per unit mass and step^2. In a
    /// tangle that is deep beside `h`, by `steps_to_clean`, a part of its depth stands in for `h`. Zero is no force.
    /// Infinity is no limit, and leaves out forces down the gradient of a path's length, which have no other size.
    pub max_step_edge_lengths: f64,
    /// Steps in which a tangle shall be gone, from rest and without resistance, whatever the edges are: with the
    /// default of `max_step_edge_lengths`, `f_max` is at least twice the depth of the tangle over the square of this.
    /// Infinity leaves the limit to the edges.
    pub steps_to_clean: f64,
    /// Thickness of the cloth in metres: what is not tangled is kept so far apart, see [`gap_m`](Self::gap_m). Without
    /// it `h` stands in where tangles are concerned, and nothing else is kept apart.
    pub thickness_m: Option<f64>,
    /// Fewest centres of a radial basis function fit.
    pub min_centres: usize,
    /// Most centres of a radial basis function fit.
    pub max_centres: usize,
    /// Vertices in the k-ring of this width round the paths are flagged as near a path. Zero are the corners of the
    /// faces that paths run through, which is enough: what is wider lets cloth that leans fall through
    /// (`docs/results/leaning.md`).
    pub path_rings: u32,
    /// Most pairs of faces that may intersect in a frame. Without it the limit goes by the size of the mesh: four for
    /// each face, and 131,072 in a small one. A frame of more is not analysed.
    pub max_face_pairs: Option<u64>,
    /// Most pairs of faces whose bounding boxes may overlap in a frame. Without it: 256 for each face, and 8,388,608
    /// in a small one. A frame of more is not analysed.
    pub max_tested_pairs: Option<u64>,
    /// Time for a frame in microseconds, from when its positions are read. The library has no clock: its caller
    /// measures the time and ends the frame through the observer of its stages, as the daemon does. Pairs of paths for
    /// which there is no time are left out, the shortest first.
    pub deadline_us: Option<u64>,
    /// Which frames the daemon repairs, for sessions with a repair service. The library itself repairs by
    /// [`relax`](crate::relax::relax).
    pub repair: Repair,
    /// Time for a repair in microseconds, from when it is asked for; the best state so far is sent then. Without it a
    /// repair ends when nothing intersects, or when nothing helps any more.
    pub repair_deadline_us: Option<u64>,
}

/// A preset of settings, to start from: a point on the measured front of time against frames to clean, see
/// `docs/results/trade.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// A fit with few centres.
    Fast,
    /// The default settings.
    #[default]
    Balanced,
    /// One displacement field for all paths together (`coupled`): the best end, for tens of times the time and more.
    /// Keeps no momentum.
    Accurate,
}

impl Quality {
    /// Sets the settings that belong to the preset, and no others.
    pub fn apply(self, settings: &mut Settings) {
        // Contour minimisation is no preset: it takes half the time of `fast`, and leaves scenes tangled. More centres
        // than by default are no preset either: they take more time, and the targets get no more accurate.
        let (response, max_centres) = match self {
            Self::Fast => (Response::Rbf, 10),
            Self::Balanced => (Response::Rbf, Settings::default().max_centres),
            Self::Accurate => (Response::Coupled, 10),
        };
        settings.response = response;
        settings.max_centres = max_centres.max(settings.min_centres);
    }
}

/// How corrections are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Response {
    /// Forces towards targets found by a radial basis function fit (Wicke, Lanker and Gross 2006).
    #[default]
    Rbf,
    /// Forces down the gradient of the path length (Volino and Magnenat-Thalmann 2006).
    Contour,
    /// Displacement towards the targets, by more than half of the distance in one step: for repairs, not simulations,
    /// since it keeps no momentum. Paths without targets get forces. Judged before it goes out: where it would make an
    /// island of paths worse it is shortened, or forces of one step stand in, or nothing moves.
    Displacement,
    /// One displacement field for all paths together that changes the shape of the cloth least, the best of several
    /// trials: for repairs, like `displacement`, and judged as that. Keeps no momentum.
    Coupled,
    /// Flags only: no forces.
    Mask,
}

/// Which frames the daemon repairs: moves to a state in which nothing intersects, in one displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Repair {
    /// Those that ask for it.
    #[default]
    Asked,
    /// Those as well at which a tangle has not shrunk for some frames.
    Auto,
    /// Each in which something intersects, unless a repair of the session is in work.
    Always,
}

/// Which of the two sides of a partitioning path is inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InsideChoice {
    /// The side with fewer vertices, as in the paper.
    #[default]
    Count,
    /// The side with the smaller area.
    Area,
    /// The side that takes less work to bring back: the sum over its vertices of area times squared distance from the
    /// path.
    Work,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            response: Response::default(),
            inside: InsideChoice::default(),
            layer_order: true,
            winding: false,
            pinned_outside: false,
            stiffness_per_step2: 0.5,
            max_step_edge_lengths: DEFAULT_MAX_STEP_EDGE_LENGTHS,
            steps_to_clean: 3.0,
            thickness_m: None,
            min_centres: 5,
            max_centres: 30,
            path_rings: 0,
            max_face_pairs: None,
            max_tested_pairs: None,
            deadline_us: None,
            repair: Repair::default(),
            repair_deadline_us: None,
        }
    }
}

/// A setting that can't be used.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("setting `{name}` is {value}; it must be {expected}")]
pub struct SettingsError {
    /// Name of the setting.
    pub name: &'static str,
    /// The value at fault.
    pub value: f64,
    /// What was expected.
    pub expected: &'static str,
}

impl Settings {
    /// The distance in metres that is kept where nothing is tangled: the thickness, where one is set. Of a pair of
    /// primitives that is joined along the surface by less than one and a half times as much nothing is asked.
    #[must_use]
    pub fn gap_m(&self) -> Option<f64> {
        self.thickness_m.filter(|&thickness_m| thickness_m > 0.0)
    }

    /// Most pairs of faces that may intersect in a frame of a mesh of `num_faces`.
    #[must_use]
    pub fn max_face_pairs(&self, num_faces: usize) -> u64 {
        self.max_face_pairs.unwrap_or((4 * num_faces as u64).max(1 << 17))
    }

    /// Most pairs of faces whose bounding boxes may overlap in a frame of a mesh of `num_faces`.
    #[must_use]
    pub fn max_tested_pairs(&self, num_faces: usize) -> u64 {
        self.max_tested_pairs.unwrap_or((256 * num_faces as u64).max(1 << 23))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`SettingsError`] with the first setting that can't be used.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        let check = |name, value: f64, good: bool, expected| {
            if good { Ok(()) } else { Err(SettingsError { name, value, expected }) }
        };
        let k = self.stiffness_per_step2;
        check("stiffness_per_step2", k, not_negative(k), "finite and not negative")?;
        let step = self.max_step_edge_lengths;
        check("max_step_edge_lengths", step, step >= 0.0, "a number that is not negative")?;
        let steps = self.steps_to_clean;
        check("steps_to_clean", steps, steps >= 1.0, "a number of at least 1")?;
        if let Some(thickness) = self.thickness_m {
            check("thickness_m", thickness, not_negative(thickness), "finite and not negative")?;
        }
        #[expect(clippy::cast_precision_loss, reason = "only for the message")]
        let (fewest, most) = (self.min_centres as f64, self.max_centres as f64);
        check("min_centres", fewest, self.min_centres >= 3, "at least 3")?;
        check(
            "max_centres",
            most,
            (self.min_centres..=1000).contains(&self.max_centres),
            "between min_centres and 1000",
        )?;
        check("path_rings", f64::from(self.path_rings), self.path_rings <= 64, "at most 64")?;
        let expected = "at least 1, or left out for a limit by the size of the mesh";
        check("max_face_pairs", 0.0, self.max_face_pairs != Some(0), expected)?;
        check("max_tested_pairs", 0.0, self.max_tested_pairs != Some(0), expected)?;
        let expected = "at least 1, or left out for no limit";
        check("repair_deadline_us", 0.0, self.repair_deadline_us != Some(0), expected)?;
        check("deadline_us", 0.0, self.deadline_us != Some(0), expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validate_accepts_defaults_and_names_bad_values() {
        assert_eq!(Settings::default().validate(), Ok(()));
        let bad = Settings { stiffness_per_step2: f64::NAN, ..Settings::default() };
        assert_eq!(bad.validate().unwrap_err().name, "stiffness_per_step2");
        let bad = Settings { min_centres: 40, ..Settings::default() };
        assert_eq!(bad.validate().unwrap_err().name, "max_centres");
        let bad = Settings { deadline_us: Some(0), ..Settings::default() };
        assert_eq!(bad.validate().unwrap_err().name, "deadline_us");
    }

    #[test]
    fn quality_presets_are_valid_and_balanced_is_the_default() {
        for quality in [Quality::Fast, Quality::Balanced, Quality::Accurate] {
            let mut settings = Settings { deadline_us: Some(7), min_centres: 200, ..Settings::default() };
            quality.apply(&mut settings);
            assert_eq!(settings.validate(), Ok(()));
            assert_eq!(settings.deadline_us, Some(7), "settings of no preset stay");
        }
        let mut settings = Settings { response: Response::Mask, max_centres: 7, ..Settings::default() };
        Quality::Balanced.apply(&mut settings);
        assert_eq!(settings, Settings::default());
    }
}
