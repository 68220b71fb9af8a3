//! Exact signs on one consistently perturbed input: the only home of geometric decisions.
//!
//! Simulation of simplicity (Edelsbrunner and Mücke 1990): every vertex is moved, symbolically, by an infinitesimal
//! amount that depends on its index alone. On the moved input no four points lie in a plane, so that a sign is never
//! zero, and all signs together belong to *one* input: all that is derived from them is consistent. The sign of the
//! unmoved determinant is found by adaptive exact arithmetic (Shewchuk 1997, crate `robust`); only where it is exactly
//! zero, the sign of the first coefficient of the perturbation that does not vanish decides.
//!
//! Distances against a given one are decided exactly as well (`distance`), without a perturbation: they are no part of
//! the topology.
//!
//! The arithmetic of signs is exact as long as no product over- or underflows; [`Frame`](crate::frame::Frame) keeps
//! coordinates in the range where that holds.

pub(crate) mod distance;
mod orientation;
mod perturbation;
mod plane;
#[cfg(test)]
mod tests;

pub use distance::{are_edges_nearer, is_vertex_nearer};
pub use orientation::{are_coplanar, side_of_plane};
pub(crate) use plane::Plane;

/// On which side of an oriented plane a point lies. There is no third answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Where the plane's vertices, seen from the point, run clockwise: a positive volume of (a, b, c, d), right-hand
    /// rule.
    Above,
    /// The other side.
    Below,
}

impl Side {
    /// The opposite side.
    #[must_use]
    pub fn flipped(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }

    fn flipped_if(self, odd: bool) -> Self {
        if odd { self.flipped() } else { self }
    }
}

/// A vertex as the predicates see it: its position and the index that decides its perturbation.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Position in metres.
    pub position: [f64; 3],
    /// Index of the vertex; no two sites of one query may share it.
    pub index: u32,
}
