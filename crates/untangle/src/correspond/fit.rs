//! How many centres a fit takes.

use super::{centres::Centres, rbf::ThinPlate, track::Track};
use crate::settings::Settings;

/// Centres beside a path lie this far from it, in edge lengths.
const CENTRE_OFFSET: f64 = 0.5;
/// Where the fit misses the path by more than this, in edge lengths, it gets more centres.
const CENTRE_TOLERANCE: f64 = 0.1;
/// How often centres are added.
const REFINEMENTS: usize = 3;

/// Fits the map from path to path, with as many centres as it takes, and says by how much it still misses the path, in metres.
pub(crate) fn fit(
    centres: &mut Centres,
    plate: &mut ThinPlate,
    track: &Track,
    sides: (f64, f64),
    edge_length_m: f64,
    mutual: bool,
    settings: &Settings,
) -> Option<f64> {
    let more = |count: usize| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "small counts"
        )]
        let more = (count as f64 * track.sampled_part()).ceil() as usize;
        more
    };
    centres.start(track, more(centre_count(track.length(), edge_length_m, settings)));
    let mut round = 0;
    loop {
        centres.place(track, sides, CENTRE_OFFSET * edge_length_m, mutual);
        if !plate.fit(&centres.from, &centres.to) {
            return None;
        }
        let (residual_m, has_more) =
            centres.refine(track, plate, CENTRE_TOLERANCE * edge_length_m, more(settings.max_centres));
        if !has_more || round == REFINEMENTS {
            return Some(residual_m);
        }
        round += 1;
    }
}

fn centre_count(length_m: f64, edge_length_m: f64, settings: &Settings) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, and is limited")]
    let wanted = (length_m / edge_length_m).round() as usize;
    wanted.saturating_add(1).clamp(settings.min_centres, settings.max_centres)
}
