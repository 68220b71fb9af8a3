//! From a point inside to its target: charts and radial basis functions.
//!
//! For each path with an inside region: a [chart](ChartKind) of the surroundings of the path and one of the surroundings of the
//! corresponding path; a thin-plate map that takes the one path to the other; and for each point inside its image, the *target*: the
//! place of the cloth that it penetrated. A [`Attraction`] is such a pair of points. On the path itself source and target coincide, and what
//! is left is the direction in which the two sheets have to part: a [`SeparationConstraint`].

mod centres;
mod chart;
mod cholesky;
mod cut;
mod find;
mod fit;
mod grid;
mod image;
mod kernel;
mod laid;
mod lift;
mod locate;
mod material;
mod memory;
mod motion;
mod patch;
mod rbf;
#[cfg(test)]
mod rbf_tests;
mod relax;
mod saddle;
#[cfg(test)]
pub(crate) mod samples;
mod shapes;
mod sheets;
#[cfg(test)]
mod tests;
mod track;
#[cfg(test)]
mod tube_tests;
mod unfold;

use std::ops::Range;

use nalgebra::{Point3, Vector3};

pub use chart::ChartKind;
pub use find::Correspondent;
pub use material::MaterialPoint;
pub use shapes::ShapeSource;

pub(crate) use chart::Chart;
pub(crate) use find::mean_edge_length;

/// A point inside and the place where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attraction {
    /// The point inside: a vertex, or a point of a face of a region without vertices.
    pub source: MaterialPoint,
    /// Its target on the corresponding sheet.
    pub target: MaterialPoint,
}

/// A point on a path and the direction in which its two sheets part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparationConstraint {
    /// The point on the sheet of the path.
    pub own: MaterialPoint,
    /// The same point of the world on the corresponding sheet.
    pub partner: MaterialPoint,
    /// World position in metres.
    pub position: Point3<f64>,
    /// Unit direction for `own`; `partner` goes the opposite way.
    pub direction: Vector3<f64>,
    /// Length of path that the point stands for, in metres; halved where the same length counts twice.
    pub length_m: f64,
}

/// The correspondence of one path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCorrespondence {
    /// Index in [`IntersectionPaths::copies`](crate::paths::IntersectionPaths::copies).
    pub copy: usize,
    /// Chart of the path and its region.
    pub own_chart: ChartKind,
    /// Chart of the surroundings of the corresponding path.
    pub partner_chart: ChartKind,
    /// Whether path and corresponding path both run round a tube.
    pub round: bool,
    /// Centres of the fit.
    pub num_centres: usize,
    /// By how much the rank of the fit falls short of full.
    pub rank_deficiency: usize,
    /// Estimate of the condition number of the fit, as far as its rank goes.
    pub condition: f64,
    /// By how much the fit misses the path between its centres at worst, in metres.
    pub residual_m: f64,
    /// Mean edge length of the faces that the path runs through, in metres.
    pub edge_length_m: f64,
    /// Its attractions in [`Correspondences::attractions`].
    pub attractions: Range<usize>,
    /// Its separations in [`Correspondences::separations`].
    pub separations: Range<usize>,
}

/// The correspondences of all paths of a frame that have one, in the order of the paths.
#[derive(Clone, Debug, Default)]
pub struct Correspondences {
    /// Path by path.
    pub paths: Vec<PathCorrespondence>,
    /// Pulls of all paths.
    pub attractions: Vec<Attraction>,
    /// Partings of all paths.
    pub separations: Vec<SeparationConstraint>,
    /// Copies of the [order of work](crate::regions::InsideRegions::order) that were looked at: all, unless time was up.
    pub num_done: usize,
}
