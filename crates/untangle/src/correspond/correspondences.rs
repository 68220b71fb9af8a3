//! What the search for correspondences finds: attractions to target points, separation constraints, and figures of each
//! path's fit.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::{charts::ChartKind, material_point::MaterialPoint};

/// A point inside and the place where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attraction {
    /// The point inside: a vertex, or a point of a face of a region without vertices.
    pub source: MaterialPoint,
    /// Its target on the corresponding sheet.
    pub target: MaterialPoint,
}

/// A point on a path and the direction in which its two sheets have to separate.
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
    /// Length of path that the point stands for, in metres: halved where the corresponding path has a constraint for
    /// the same length.
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
    /// Whether path and corresponding path both wind round a tube.
    pub round: bool,
    /// Centres of the fit.
    pub num_centres: usize,
    /// By how much the rank of the fit is below full.
    pub rank_deficiency: usize,
    /// Estimate of the condition number of the fit, over the part that has full rank.
    pub condition: f64,
    /// By how much the fit misses the path between its centres at worst, in metres.
    pub residual_m: f64,
    /// Mean edge length of the faces that the path runs through, in metres.
    pub edge_length_m: f64,
    /// Its attractions in [`Correspondences::attractions`].
    pub attractions: Range<usize>,
    /// Its separation constraints in [`Correspondences::separations`].
    pub separations: Range<usize>,
}

/// The correspondences of all paths of a frame that have one, in the order of the paths.
#[derive(Clone, Debug, Default)]
pub struct Correspondences {
    /// Path by path.
    pub paths: Vec<PathCorrespondence>,
    /// Attractions of all paths.
    pub attractions: Vec<Attraction>,
    /// Separation constraints of all paths.
    pub separations: Vec<SeparationConstraint>,
    /// Copies of the [order of work](crate::regions::InsideRegions::order) that were done: all, unless time was up.
    pub num_done: usize,
}
