//! Extremes of one kind each.

mod contact;
mod fits;
mod laws;
mod numbers;
mod place;
mod refusals;
mod shape;
mod time;

use super::case::Chapter;

/// All chapters, in the order of the document.
pub fn chapters() -> Vec<Chapter> {
    vec![
        place::chapter(),
        shape::chapter(),
        contact::chapter(),
        fits::chapter(),
        laws::chapter(),
        numbers::chapter(),
        refusals::chapter(),
    ]
}
