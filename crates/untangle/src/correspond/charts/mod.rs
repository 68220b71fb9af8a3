//! Charts: two-dimensional coordinates of a part of the cloth, roughly in metres.
//!
//! A [`Patch`](patch::Patch) of faces gets a flat [shape](shapes) for each of them; [`unfolding`] puts the shapes
//! together; a patch that closes on itself is [cut] open to a disc first, and one that does not unfold gets an
//! as-rigid-as-possible [parameterization]. The [`Chart`] keeps the result and [locates](locator) points in it.
//!
//! A chart that was cut open goes on beyond the cut: its *universal cover* is the plane filled with copies of the
//! chart, and the *deck transformations*, powers of one [`Similarity`] (the *period*), take one copy to the next.

mod chart;
mod cut;
mod locator;
mod parameterization;
mod patch;
mod period;
mod shapes;
mod similarity;
#[cfg(test)]
mod tests;
mod unfolding;

pub use chart::ChartKind;
pub use shapes::ShapeSource;

pub(crate) use chart::Chart;
pub(crate) use period::deck_transformations;
pub(crate) use similarity::Similarity;
