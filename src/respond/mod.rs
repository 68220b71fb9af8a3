//! From inside regions and targets to corrections.

pub(crate) mod contour;
mod displace;
mod flags;
mod forces;
mod push;
mod responder;
#[cfg(test)]
mod tests;

use nalgebra::Vector3;

pub use responder::Responder;

/// What a host should know about a vertex, besides its correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VertexFlags(pub u32);

impl VertexFlags {
    /// Inside of at least one path: switch the host's self-collision off here.
    pub const INSIDE: Self = Self(1);
    /// On, or within the chosen rings of, a path: switch it off here too.
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
    /// Force on each vertex in kg m / step^2: divided by the mass, it is the displacement of one step. With no masses given,
    /// every vertex weighs 1 kg.
    pub forces: Vec<Vector3<f64>>,
    /// Flags of each vertex.
    pub flags: Vec<VertexFlags>,
    /// Sum of all forces before the limit and the pins, in the unit of `forces`.
    pub net_force: Vector3<f64>,
    /// Sum of all torques about the centre of the forced vertices, before the limit and the pins, in kg m^2 / step^2.
    pub net_torque: Vector3<f64>,
    /// Length of the longest displacement of one step, in metres.
    pub max_displacement_m: f64,
    /// What time did not suffice for.
    pub left_out: LeftOut,
}

/// Pairs of paths, the shortest ones, that got flags near the path but neither a region nor forces since time was up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Number of pairs.
    pub num_pairs: usize,
    /// Their length in the world in metres.
    pub length_m: f64,
}
