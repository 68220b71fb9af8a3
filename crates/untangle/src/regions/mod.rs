//! Inside regions: the parts of the cloth that are on the wrong side of a path.

mod agreement;
mod detours;
mod disc;
mod finder;
mod flood;
mod left_of_path;
mod side;
mod similarity;
mod view;

use std::ops::Range;

use crate::{mesh::VertexId, paths::IntersectionPaths};

pub use finder::RegionFinder;

/// The inside region of one path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InsideRegion {
    /// Whether the path divides its piece (or, for BLI, its disc) in two.
    pub partitioning: bool,
    /// Its vertices in [`InsideRegions::vertices`], ascending, without loop vertices. Empty where nothing separates, no
    /// vertex lies inside, or the other path of the pair carries the region of both.
    pub vertices: Range<usize>,
    /// Whether only both paths of the pair together divide the piece: the first then carries the vertices of both.
    pub joint: bool,
    /// Radius of the disc round the loop vertex (BLI, BLB), in the unit of the texture coordinates, or in metres where
    /// rest lengths stand in for them.
    pub disc_radius: Option<f64>,
}

/// The inside regions of all paths of a frame.
#[derive(Clone, Debug, Default)]
pub struct InsideRegions {
    /// For each entry of [`IntersectionPaths::copies`](crate::paths::IntersectionPaths) its region; nothing for II and
    /// BI, which have one only jointly with their corresponding path.
    pub by_copy: Vec<Option<InsideRegion>>,
    /// Vertices of all regions.
    pub vertices: Vec<VertexId>,
    /// The order of work in a frame: all copies, the longest pairs first.
    pub order: Vec<usize>,
    /// Number of copies of `order` that were processed: all, unless time was up.
    pub num_done: usize,
}

impl InsideRegions {
    /// Clears the regions, and sorts the paths of a frame into the order of work.
    fn reset(&mut self, paths: &IntersectionPaths) {
        self.by_copy.clear();
        self.by_copy.resize(paths.copies.len(), None);
        self.vertices.clear();
        self.order.clear();
        self.order.extend(0..paths.copies.len());
        let length_m = |copy: usize| paths.pairs[paths.copies[copy].pair].length_m;
        self.order.sort_unstable_by(|&a, &b| {
            let by_length = length_m(b).total_cmp(&length_m(a));
            by_length.then((paths.copies[a].pair, a).cmp(&(paths.copies[b].pair, b)))
        });
        self.num_done = 0;
    }

    /// The vertices inside of one path, ascending; empty for a path without a region.
    #[must_use]
    pub fn vertices_of(&self, copy: usize) -> &[VertexId] {
        self.by_copy[copy].as_ref().map_or(&[], |region| &self.vertices[region.vertices.clone()])
    }
}

/// Whether another pair of paths begins at a place of the order of work: a frame that runs out of time ends between
/// pairs.
pub(crate) fn starts_pair(paths: &IntersectionPaths, order: &[usize], place: usize) -> bool {
    place == 0 || paths.copies[order[place - 1]].pair != paths.copies[order[place]].pair
}
