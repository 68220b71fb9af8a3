//! Separation certificates: what a test of one frame says about the next ones.
//!
//! Two faces whose distance is `d` do not intersect for as long as their displacements sum up to less than `d`; the
//! same holds, with a bound of its own ([`clearance_m`](super::filter::VertexStarFilter::clearance_m)), for the faces
//! around a vertex. So every test that succeeds leaves a *certificate* that expires at some *time*, where time is
//! measured by clocks that run as vertices move: the clock of a set of vertices advances, each frame, by the largest
//! displacement in it. Only what has expired is tested again (kinetic data structures, Basch, Guibas and Hershberger
//! 1999). A translation that all vertices share brings nothing closer together and is left out.
//!
//! Rounding: clocks are rounded up, expiries down. So the answers are those of a cold search.

mod certificates;
mod clocks;
mod displacements;
mod leaf_pairs;
mod stars;

pub(super) use certificates::{CertificateCache, Mode, PAIRS_PER_GROUP, STARS_PER_GROUP};
pub(super) use leaf_pairs::{CollectLeafPairs, ExpiredLeafPairs};
pub(super) use stars::ExpiredStars;
