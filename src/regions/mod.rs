//! Inside regions: the part of the cloth that is on the wrong side of a path.

mod disc;
mod finder;
mod flood;
mod left;
mod pair;
mod side;
mod winding;
mod work;

use std::ops::Range;

use crate::mesh::VertexId;

pub use finder::RegionFinder;

/// The inside region of one path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InsideRegion {
    /// Whether the path divides its piece (or, for BLI, its disc) in two.
    pub partitioning: bool,
    /// Its vertices in [`InsideRegions::vertices`], ascending, loop vertices left out. Empty where nothing separates, no vertex lies
    /// inside, or another path of the pair carries the region of both.
    pub vertices: Range<usize>,
    /// Whether only both paths of the pair together divide the piece: the first then carries the vertices of both.
    pub joint: bool,
    /// Radius of the disc round the loop vertex in the units of the texture coordinates, or of the rest lengths in metres (BLI, BLB).
    pub disc_radius: Option<f64>,
}

/// The inside regions of all paths of a frame.
#[derive(Clone, Debug, Default)]
pub struct InsideRegions {
    /// For each entry of [`IntersectionPaths::copies`](crate::paths::IntersectionPaths) its region; nothing for II and BI, which have
    /// none but jointly with their corresponding path.
    pub by_copy: Vec<Option<InsideRegion>>,
    /// Vertices of all regions.
    pub vertices: Vec<VertexId>,
}

impl InsideRegions {
    /// The vertices inside of one path, ascending; empty for a path without a region.
    #[must_use]
    pub fn vertices_of(&self, copy: usize) -> &[VertexId] {
        self.by_copy[copy].as_ref().map_or(&[], |region| &self.vertices[region.vertices.clone()])
    }
}
