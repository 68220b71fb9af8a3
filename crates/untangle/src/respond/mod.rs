//! From inside regions and targets to corrections.
//!
//! Units: a force is in kg m / step^2, so that force over mass is the displacement of one step. `h` is the mean edge
//! length of the faces that the path runs through, `m` the mass of the point at which the force acts, `k` is
//! `stiffness_per_step2`, `D` the depth of the tangle, `f_max` is `max_step_edge_lengths * max(h, 10 D / n^2)` with `n`
//! `steps_to_clean` (for a push 5/3 of it), `o` half the thickness of the cloth, or half of the larger of `h` and `D /
//! 5` where none is set. Numbers in brackets are equations of Wicke, Lanker and Gross (2006).
//!
//! - Force law: `F(d) = min(k (d + o), f_max)`. Equation (4) prints `max(k d, f_max)`; the text says `min`, and without
//!   `o` the force vanishes with the gap, where the stiffness of the cloth stalls it.
//! - Attraction of a point inside `r` to its target `r'`: `+m F(|r' - r|) e` at `r` and its opposite at `r'`, with `e`
//!   from `r` to `r'`, as in (4); for a region without vertices one point in each face.
//! - Separation constraint in the middle of a path segment of length `l`: `2 m F(0) (l / h) e` and its opposite in the
//!   other sheet, with `e` from conormal to conormal: the limit of the attraction on the path. The paper has none;
//!   small regions need it.
//! - Boundary push of segment `i` of a BI path: `2 m (s'_i - s_i)` and its opposite in the other sheet, with `s'` the
//!   mean over the path of `F(h(u)) (-grad h)` on the partner and `s` the same on its own sheet. Equations (6) and (7)
//!   act on all vertices of the path's faces, which keeps linear momentum only. Its limit is `max_step_edge_lengths *
//!   h`.
//! - Field round a pushed path, in a tangle deeper than `h`: the same steps, from the path on along the edges up to
//!   four times `D`, fading, less the rigid motion that takes their net force and torque away. The paper has none; the
//!   faces along a path have the less mass the finer the mesh is.
//! - Boundary push of a path round two tubes: the same, over the boundary of the one that is nearer. The paper has
//!   none; to slip one tube off the other takes no strain.
//! - Contour minimisation of BI and of any path without targets: `-f_max` times the mean mass along the path times the
//!   gradient of its length, with `f_max` by `h` alone. The paper has none; it acts also where the push cancels.
//!
//! Each force acts in a point of a face and is spread over its corners by barycentric weights, and each has an
//! opposite, in the same place or along the line between both: so linear and angular momentum are kept, exactly but for
//! rounding, and [`Corrections`] says how much of both is left over. Then, per vertex, the sum over all paths is
//! limited to `3 f_max m`, and pinned vertices get no force; both break the balance, and a host that needs it looks at
//! [`VertexFlags::CLAMPED`]. CLOSED and LL get each force from both sides, as (4) does when it is applied
//! symmetrically. Displacements (section 5.2) are means of `0.6 d + o / 2` along `e`, and keep no momentum.
//!
//! Where a thickness `t` is set, pairs of primitives outside of all tangles at a distance `d` below `1.5 t` are set
//! apart as well: by `F(t - d)` along the line of their closest points, shared by the masses of both, and divided by
//! the number of such pairs at a vertex; as a displacement by `t - d`.

mod boundary_distance;
mod boundary_push;
pub(crate) mod contour;
mod corrections;
mod displace;
mod flags;
mod forces;
mod path_forces;
mod responder;
#[cfg(test)]
mod tests;

use nalgebra::Vector3;

pub use responder::Responder;

use crate::{labels::VertexLabel, mesh::VertexId};

/// What a host should know about a vertex, besides its correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VertexFlags(pub u32);

impl VertexFlags {
    /// Inside of at least one path: switch the host's self-collision off here.
    pub const INSIDE: Self = Self(1);
    /// On a path, or in the k-ring round it that the settings choose: switch it off here too.
    pub const NEAR_PATH: Self = Self(1 << 1);
    /// The correction was limited.
    pub const CLAMPED: Self = Self(1 << 2);
    /// Pinned: never corrected.
    pub const PINNED: Self = Self(1 << 3);

    /// Whether all flags of `other` are set.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Sets the flags of `other`.
    pub fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// Corrections of all vertices for one frame.
#[derive(Clone, Debug, Default)]
pub struct Corrections {
    /// Force on each vertex in kg m / step^2: divided by the mass, it is the displacement of one step. With no masses
    /// given, every vertex weighs 1 kg.
    pub forces: Vec<Vector3<f64>>,
    /// Flags of each vertex.
    pub flags: Vec<VertexFlags>,
    /// Vertices that have a force or a flag other than pinned, ascending: all others need not be looked at.
    pub touched: Vec<VertexId>,
    /// Labels of some vertices, by vertex, then by pair: which contacts have to be off. Empty unless they were asked
    /// for ([`Responder::set_labelled`]).
    pub labels: Vec<VertexLabel>,
    /// Sum of all forces before the limit and the pins, in the unit of `forces`.
    pub net_force: Vector3<f64>,
    /// Sum of all torques about the centre of the forced vertices, before the limit and the pins, in kg m^2 / step^2.
    pub net_torque: Vector3<f64>,
    /// Length of the longest displacement of one step, in metres.
    pub max_displacement_m: f64,
    /// Pairs of paths for which there was no time.
    pub left_out: LeftOut,
}

/// Pairs of paths, the shortest ones, that got flags near the path but neither a region nor forces, since time was up;
/// and what else there was no time for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Number of pairs.
    pub num_pairs: usize,
    /// Their length in the world in metres.
    pub length_m: f64,
    /// Whether nothing was kept apart that is nearer than [`gap_m`](crate::settings::Settings::gap_m), for want of time
    /// or since there are too many pairs.
    pub gap: bool,
}
