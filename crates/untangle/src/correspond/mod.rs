//! From a point inside to its target: charts and radial basis functions.
//!
//! For each path with an inside region: a [chart](ChartKind) of the surroundings of the path and one of the
//! surroundings of the corresponding path; a thin-plate spline that maps the one path to the other; and for each point
//! inside its image, the *target*: the place of the cloth that it penetrated. An [`Attraction`] is such a pair of
//! points. On the path itself source and target coincide; there a [`SeparationConstraint`] gives the limit of the
//! direction from source to target, in which the two sheets have to separate.
//!
//! | module | technique |
//! |---|---|
//! | `charts` | patches unfolded into the plane, cut open if they close on themselves, or as-rigid-as-possible |
//! | `linalg` | sparse Cholesky factorisation; the saddle-point system of a fit |
//! | `lifted` | paths in charts, lifted to the universal cover |
//! | `fit` | the thin-plate spline from path to path, and its centres |
//!
//! The driver, [`Correspondent`], takes a path (`path_input`), makes its two charts (`chart_pair`), lifts the path,
//! fits, and collects `separations` and `targets`; the second path of a pair reuses what the first one found
//! (`shared_by_pair`).

mod chart_pair;
mod charts;
mod correspondences;
mod correspondent;
mod fit;
mod lifted;
mod linalg;
mod material_point;
mod path_input;
mod separations;
mod shared_by_pair;
mod targets;
#[cfg(test)]
mod tests;

pub use charts::{ChartKind, ShapeSource};
pub use correspondences::{Attraction, Correspondences, PathCorrespondence, SeparationConstraint};
pub use correspondent::Correspondent;
pub use material_point::MaterialPoint;

pub(crate) use charts::Chart;
pub(crate) use linalg::{Cholesky, SparseSymmetric};
#[cfg(test)]
pub(crate) use tests::samples;
