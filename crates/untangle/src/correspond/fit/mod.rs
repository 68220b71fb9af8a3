//! The fit of a map from path to corresponding path: a thin plate through [centres] on the path, refined where it
//! misses the path.

mod centres;
mod kernel;
#[cfg(test)]
mod tests;
mod thin_plate;

pub(super) use centres::Centres;
pub(super) use thin_plate::ThinPlate;

use super::lifted::LiftedPair;
use crate::settings::Settings;

/// Centres beside a path lie this far from it, in edge lengths.
const CENTRE_OFFSET: f64 = 0.5;
/// Where the fit misses the path by more than this, in edge lengths, it gets more centres.
const CENTRE_TOLERANCE: f64 = 0.1;
/// How often centres are added.
const MAX_REFINEMENTS: usize = 3;

/// A fitted map and its centres, in memory that is kept from one path to the next.
#[derive(Debug, Default)]
pub(super) struct PathFit {
    pub(super) centres: Centres,
    pub(super) plate: ThinPlate,
}

impl PathFit {
    /// Fits the map from path to corresponding path, with as many centres as it takes, and returns by how much it still
    /// misses the path at worst, in metres. Nothing where the system can't be solved.
    ///
    /// `sides` are those of inside and image, and `is_mutual` says that the map is its own inverse, as for
    /// [`Centres::place`].
    ///
    /// Cost: cubic in the centres.
    pub(super) fn fit(
        &mut self,
        pair: &LiftedPair,
        sides: (f64, f64),
        edge_length_m: f64,
        is_mutual: bool,
        settings: &Settings,
    ) -> Option<f64> {
        let Self { centres, plate } = self;
        let sampled = |count: usize| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "small counts"
            )]
            let sampled = (count as f64 * pair.sampled_part()).ceil() as usize;
            sampled
        };
        centres.start(pair, sampled(num_centres(pair.length(), edge_length_m, settings)));
        let mut num_refinements = 0;
        loop {
            centres.place(pair, sides, CENTRE_OFFSET * edge_length_m, is_mutual);
            if !plate.fit(&centres.from, &centres.to) {
                return None;
            }
            let (residual_m, is_refined) =
                centres.refine(pair, plate, CENTRE_TOLERANCE * edge_length_m, sampled(settings.max_centres));
            if !is_refined || num_refinements == MAX_REFINEMENTS {
                return Some(residual_m);
            }
            num_refinements += 1;
        }
    }
}

/// Centres before any refinement: about one for each edge length of the path, within the limits of the settings.
fn num_centres(length_m: f64, edge_length_m: f64, settings: &Settings) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, and is limited")]
    let wanted = (length_m / edge_length_m).round() as usize;
    wanted.saturating_add(1).clamp(settings.min_centres, settings.max_centres)
}
