//! Paths in charts, lifted to the universal cover: a path that crosses a cut goes on in the next copy of the chart.

mod pair;
mod path;
mod side;

pub(super) use pair::LiftedPair;
pub(super) use path::LiftedPath;
