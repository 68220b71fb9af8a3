//! The limit on what may intersect, for `check` and `fix`.

use std::path::PathBuf;

use untangle::{
    analysis::{Analyser, Analysis},
    intersect::SearchEnd,
    settings::Settings,
    stage::StageObserver,
};

use super::input::{Input, InputError, names};

/// Most pairs of triangles that may intersect, where the user gives no limit: they take about three gigabytes, up to
/// eight where each is a path of its own.
pub(super) const MAX_FACE_PAIRS: u64 = 4_000_000;

/// Analyses files, unless more than `max_face_pairs` of their triangles intersect. However many boxes overlap, there is
/// no limit of time: a person or a script is there to end it.
pub(super) fn analyse_within(
    files: &[PathBuf],
    Input { mesh, frame, .. }: &Input,
    max_face_pairs: u64,
    observer: &mut dyn StageObserver,
) -> Result<Analysis, InputError> {
    let (max_face_pairs, max_tested_pairs) = (Some(max_face_pairs), Some(u64::MAX));
    let settings = Settings { max_face_pairs, max_tested_pairs, ..Settings::default() };
    let mut analyser = Analyser::default();
    let analysis = analyser.analyse(mesh, frame, &settings, observer).clone();
    match analyser.search_end() {
        SearchEnd::Complete => Ok(analysis),
        SearchEnd::TooManyPairs | SearchEnd::OutOfTime => {
            Err(InputError::TooManyFacePairs { files: names(files), limit: max_face_pairs.unwrap_or_default() })
        }
    }
}
