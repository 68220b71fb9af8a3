//! The search of one share of a frame: pairs from the broad phase, through the filters, to exact contacts.
//!
//! [`Search`] holds what every share needs; what a share consists of is its parameter, and each kind of share is a
//! [`Task`](crate::simd::Task): pairs of subtrees ([`subtrees`]), vertex stars ([`stars`]), and those of the cache.

mod share;
mod stars;
mod subtrees;

pub(super) use share::{Search, Share};
pub(super) use stars::VertexStars;
pub(super) use subtrees::SubtreePairs;
