//! How far targets are off, on folded sheets where the truth is known.

use std::error::Error;

use untangle::{frame::Frame, mesh::Mesh, settings::Response, untangler::Untangler};
use untangled_testkit::generate::mirrored::{CURVES, sheet};

use super::{run::sent, setup::Setup};

const SIZES: [f64; 2] = [0.5, 1.0];

/// Distances of targets from the truth, in edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TargetErrors {
    /// Mean over the sheets of the mean over the targets.
    pub(crate) mean: f64,
    /// Largest of all.
    pub(crate) max: f64,
}

/// Measures the targets of a setup; nothing for a response that has none.
///
/// # Errors
/// None for sheets that can be built.
pub(crate) fn measure(setup: &Setup, edges_m: &[f64]) -> Result<Option<TargetErrors>, Box<dyn Error>> {
    if matches!(setup.settings.response, Response::Contour | Response::Mask) {
        return Ok(None);
    }
    let (mut sum, mut count, mut max) = (0.0, 0.0, 0.0f64);
    for curve in &CURVES {
        for size in SIZES {
            for &edge_m in edges_m {
                let sheet = sheet(curve, size, edge_m, setup.knowledge)?;
                let frame = frame(&sheet.mesh, &sheet.frame, setup)?;
                let mut untangler = Untangler::new(sheet.mesh.clone().into(), setup.settings.clone())?;
                let outcome = untangler.process(&frame, &mut ());
                let Some((path, _)) = sheet.path(outcome.analysis, outcome.correspondences) else { continue };
                let errors = sheet.errors(outcome.correspondences, path);
                let Some(largest) = errors.last() else { continue };
                max = max.max(*largest);
                #[expect(clippy::cast_precision_loss, reason = "a count of targets")]
                let mean = errors.iter().sum::<f64>() / errors.len() as f64;
                sum += mean;
                count += 1.0;
            }
        }
    }
    Ok((count > 0.0).then(|| TargetErrors { mean: sum / count, max }))
}

fn frame(mesh: &Mesh, exact: &Frame, setup: &Setup) -> Result<Frame, Box<dyn Error>> {
    let points = exact.positions().iter().map(|&position| position.into()).collect();
    Ok(Frame::new(mesh, &sent(points, setup.wire))?)
}
