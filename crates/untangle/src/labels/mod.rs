//! Labels: for each vertex the pairs of paths that it is tangled in, and its side of them, so that a host switches off
//! the contacts between the two sides of a tangle and no others.
//!
//! A host's self-contact defends a tangle, so part of it has to be off while the tangle comes apart. The flags of
//! [`Corrections`](crate::respond::Corrections) switch off *all* contacts of a vertex, also those with cloth that it
//! lies on, and whatever leans there falls through. Labels name pairs: a contact between two ends (a vertex, an edge or
//! a face each) is off where both ends hold labels of one pair whose sides, or-ed, give 3.
//!
//! `label = 4 * pair + side`, side 1 or 2 for the two sheets of the pair, 3 for both.
//!
//! What is labelled, for a path and its corresponding path of a pair:
//! - *inside*: the inside region of each, with its side. A path that is its own partner (LL, BLI, BLB) folds back on
//!   one sheet: side 3.
//! - *near*: the corners of all faces that the path runs through, and what lies no farther from it than half the
//!   thickness of the cloth (half a mean edge where none is set), so that a path can move, and there is a path to move
//!   where it has no inside. A pair without an inside, such as BI/BI, has to slip off over half of its length: so far.
//! - *within reach*: on the other sheet of a region, what lies no farther from the path than the region is deep: no
//!   point of the region can touch more of this sheet. Depth is the largest distance of a vertex inside from its path.
//!   Within reach of each other two sheets that have not passed each other must keep apart, cloth that leans: so these
//!   vertices hold no label that switches contacts among themselves off. Where both sheets have some, one pair of paths
//!   has two numbers, its own, and that plus the number of all pairs.
//!
//! Distances are geodesic, in metres, in the frame as it is: the same tangle on a finer mesh has the same labels.

mod finder;
mod surroundings;
#[cfg(test)]
mod tests;

use crate::mesh::VertexId;

pub use finder::Labeller;

/// A vertex and its side of one pair of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct VertexLabel {
    /// The vertex.
    pub vertex: VertexId,
    /// `4 * pair + side`, see the [module](self).
    pub label: u32,
}

impl VertexLabel {
    /// Side of the first path of a pair.
    pub const FIRST: u32 = 1;
    /// Side of the second path of a pair.
    pub const SECOND: u32 = 2;
    /// Both sides: where a path is its own partner, or one vertex lies on both sides.
    pub const BOTH: u32 = 3;

    /// The number of the pair. Below the number of pairs of the frame it is an index into
    /// [`IntersectionPaths::pairs`](crate::paths::IntersectionPaths::pairs); otherwise it is that index plus the number
    /// of pairs.
    #[must_use]
    pub fn pair(self) -> u32 {
        self.label >> 2
    }

    /// The side: 1, 2, or 3 for both.
    #[must_use]
    pub fn side(self) -> u32 {
        self.label & 3
    }
}
