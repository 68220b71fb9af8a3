//! How much a search may do, how it ended, and the rounds between which that is decided.

use super::search::Share;
use crate::{settings::Settings, stage::StageObserver};

/// Work of one round over all shares together, in [units](Share::spend): some milliseconds on one thread.
const WORK_PER_ROUND: usize = 1 << 19;

/// Least and most work of one share in a round.
const WORK_PER_SHARE: [usize; 2] = [1 << 10, 1 << 15];

/// What ends a search, so that neither its memory nor its time grows with the square of the faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchLimits {
    /// Most pairs of faces that may intersect.
    pub max_found: u64,
    /// Most pairs of faces without a common vertex whose bounding boxes may overlap; the same for pairs round vertices
    /// of many faces.
    pub max_tested: u64,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SearchEnd {
    /// Everything that intersects was found.
    #[default]
    Complete,
    /// More pairs of faces intersect, or might, than the limits allow.
    TooManyPairs,
    /// The observer said that time is up.
    OutOfTime,
}

impl SearchLimits {
    /// No limits: memory is that of the answer.
    pub const NONE: Self = Self { max_found: u64::MAX, max_tested: u64::MAX };

    /// The limits of the settings, for a mesh of `num_faces`.
    #[must_use]
    pub fn new(settings: &Settings, num_faces: usize) -> Self {
        Self { max_found: settings.max_face_pairs(num_faces), max_tested: settings.max_tested_pairs(num_faces) }
    }
}

/// Decides after each round whether there is another one.
///
/// The counts that it decides by depend on the mesh and the frame alone, not on threads, nor on what is cached.
pub(super) struct Rounds<'a> {
    limits: SearchLimits,
    observer: &'a mut dyn StageObserver,
}

impl<'a> Rounds<'a> {
    pub(super) fn new(limits: SearchLimits, observer: &'a mut dyn StageObserver) -> Self {
        Self { limits, observer }
    }

    /// Searches shares, in as many rounds as it takes.
    pub(super) fn run(&mut self, shares: &mut [Share], mut round: impl FnMut(&mut [Share])) -> SearchEnd {
        shares.iter_mut().for_each(Share::begin);
        loop {
            allow(shares);
            round(shares);
            if let Some(end) = self.end(shares) {
                return end;
            }
        }
    }

    /// The end of the search, if the last round brought it.
    fn end(&mut self, shares: &[Share]) -> Option<SearchEnd> {
        let sum = |count: fn(&Share) -> u64| shares.iter().map(count).sum::<u64>();
        let num_found = sum(|share| share.contacts.len() as u64);
        let num_tested = sum(|share| share.num_boxes).max(sum(|share| share.num_around));
        if num_found > self.limits.max_found || num_tested > self.limits.max_tested {
            return Some(SearchEnd::TooManyPairs);
        }
        if shares.iter().all(|share| share.is_done) {
            return Some(SearchEnd::Complete);
        }
        self.is_spent().then_some(SearchEnd::OutOfTime)
    }

    pub(super) fn is_spent(&mut self) -> bool {
        self.observer.is_spent()
    }
}

/// Gives shares their work for a round.
fn allow(shares: &mut [Share]) {
    let num_active = shares.iter().filter(|share| !share.is_done).count();
    let [least, most] = WORK_PER_SHARE;
    let work = (WORK_PER_ROUND / num_active.max(1)).clamp(least, most);
    shares.iter_mut().for_each(|share| share.allow(work));
}
