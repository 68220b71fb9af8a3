//! The search of one share of a frame: pairs from the broad phase, through the filters, to exact contacts.
//!
//! [`Search`] holds what every share needs; what a share consists of is its parameter, and each kind of share is a
//! [`Task`](crate::simd::Task): pairs of subtrees ([`subtrees`]), vertex stars ([`stars`]), and those of the cache.
//!
//! A task does as much as its share is allowed in this round, and goes on from there in the next one.

mod share;
mod stars;
mod subtrees;

pub(super) use share::{Search, Share};
pub(super) use stars::{STAR_TEST, VertexStars};
pub(super) use subtrees::SubtreePairs;
