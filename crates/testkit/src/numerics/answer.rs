//! What the library says about a state, and how far two such answers lie apart.

use std::sync::Arc;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{
    analysis::Analysis,
    correspond::PathCorrespondence,
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    respond::Corrections,
    settings::{Response, Settings},
    untangler::Untangler,
};

use super::case::ensure;
use crate::{
    generate::{Sheet, crumpled},
    judge::{Summary, brute_force, rules, summary},
};

pub(super) const RESPONSES: [Response; 5] =
    [Response::Rbf, Response::Contour, Response::Displacement, Response::Coupled, Response::Mask];

/// An analysis with its correction.
pub(super) struct Answer {
    pub(super) topology: Summary,
    pub(super) fits: Vec<PathCorrespondence>,
    pub(super) corrections: Corrections,
    pub(super) analysis: Analysis,
}

/// Crumpled sheets in general position, the first of 60.
pub(super) fn sheets(count: u64) -> Vec<Sheet> {
    (0..count).map(|seed| crumpled(seed, [6, 9, 13][usize::try_from(seed % 3).unwrap()])).collect()
}

pub(super) fn answer(mesh: &Arc<Mesh>, frame: &Frame, settings: Settings) -> Result<Answer, String> {
    let mut untangler = Untangler::new(mesh.clone(), settings).map_err(|error| error.to_string())?;
    let outcome = untangler.process(frame, &mut ());
    let answer = Answer {
        topology: summary(mesh, outcome.analysis, |vertex| vertex, |face| face),
        fits: outcome.correspondences.paths.clone(),
        corrections: outcome.corrections.clone(),
        analysis: outcome.analysis.clone(),
    };
    answer.check_finite()?;
    Ok(answer)
}

/// The answer for these positions with the default settings.
pub(super) fn default_answer(mesh: &Arc<Mesh>, positions: &[[f64; 3]]) -> Result<Answer, String> {
    answer(mesh, &frame(mesh, positions)?, Settings::default())
}

pub(super) fn frame(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<Frame, String> {
    Frame::new(mesh, positions).map_err(|error| error.to_string())
}

/// Positions as a host of single precision has them.
pub(super) fn rounded(positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    positions.iter().map(|position| position.map(|x| f64::from(x as f32))).collect()
}

/// Finite corrections by every response; returns how many pairs of faces intersect.
pub(super) fn check_all_responses(mesh: &Arc<Mesh>, frame: &Frame) -> Result<usize, String> {
    let mut num_segments = 0;
    for response in RESPONSES {
        let found = answer(mesh, frame, Settings { response, ..Settings::default() });
        num_segments = found.map_err(|words| format!("{response:?}: {words}"))?.analysis.intersections.segments.len();
    }
    Ok(num_segments)
}

/// What holds for any mesh: the intersections are those that brute force finds with the same signs, and the paths obey
/// the rules.
pub(super) fn check_against_brute_force(mesh: &Mesh, frame: &Frame, analysis: &Analysis) -> Result<(), String> {
    let found: Vec<_> = analysis.intersections.edge_face.iter().map(|hit| (hit.edge, hit.face)).collect();
    ensure(found == brute_force::edge_face_intersections(mesh, frame), || "not what brute force finds".into())?;
    let size = frame.positions().iter().flat_map(|point| point.iter()).fold(0.0, |size: f64, x| size.max(x.abs()));
    // Weights are ratios of volumes; where these vanish, the middle of a face stands in for a place that has none.
    rules::check_paths(mesh, frame, analysis, 1e9 * (size + f64::MIN_POSITIVE));
    Ok(())
}

impl Answer {
    fn check_finite(&self) -> Result<(), String> {
        let Corrections { forces, net_force, net_torque, max_displacement_m, .. } = &self.corrections;
        let vectors = forces.iter().chain([net_force, net_torque]);
        let finite =
            vectors.flat_map(|vector| vector.iter()).chain([max_displacement_m]).all(|value| value.is_finite());
        ensure(finite, || "a correction is not finite".into())?;
        let points = self.analysis.paths.points.iter().flat_map(|point| point.position.coords.data.0[0]);
        let lengths = self.analysis.paths.pairs.iter().map(|pair| pair.length_m);
        ensure(points.chain(lengths).all(f64::is_finite), || "a path is not finite".into())?;
        let numbers = self.fits.iter().flat_map(|fit| [fit.residual_m, fit.edge_length_m]);
        ensure(numbers.chain(self.fits.iter().map(|fit| fit.condition)).all(f64::is_finite), || {
            "a fit is not finite".into()
        })
    }

    pub(super) fn is_same_topology(&self, other: &Self) -> bool {
        self.topology == other.topology
    }

    /// Longest difference of two forces, of which `other`'s are to be multiplied by `scale`, as a part of the longest
    /// force.
    pub(super) fn difference(&self, other: &Self, scale: f64) -> f64 {
        let longest = |forces: &mut dyn Iterator<Item = Vector3<f64>>| forces.map(|f| f.norm()).fold(0.0, f64::max);
        let pairs = self.corrections.forces.iter().zip(&other.corrections.forces);
        let apart = longest(&mut pairs.map(|(a, b)| a - b * scale));
        let size = longest(&mut self.corrections.forces.iter().copied());
        if size > 0.0 { apart / size } else { apart }
    }

    /// Worst condition number of its fits; 1 where there are none.
    pub(super) fn condition(&self) -> f64 {
        self.fits.iter().map(|fit| fit.condition).fold(1.0, f64::max)
    }
}

/// Masses whose logarithms are even over so many decades round 1 kg.
pub(super) fn spread(count: usize, decades: f64, with_zeros: bool) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mass = |index: usize| {
        let mass = 10f64.powf(rng.random_range(-0.5..0.5) * decades);
        if with_zeros && index.is_multiple_of(7) { 0.0 } else { mass }
    };
    (0..count).map(mass).collect()
}

/// A mesh with masses.
pub(super) fn with_masses(faces: Vec<[u32; 3]>, masses: &[f64]) -> Arc<Mesh> {
    let description = MeshDescription {
        num_vertices: masses.len(),
        faces,
        masses_kg: Some(masses.to_vec()),
        ..MeshDescription::default()
    };
    Arc::new(Mesh::new(description).unwrap())
}
