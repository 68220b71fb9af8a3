//! What several examples need: a host without a daemon, and tangles whose targets are known.

#![allow(dead_code, unreachable_pub, reason = "each example uses a part")]

pub mod host;
pub mod mirrored;

/// What a mesh tells about its shape, and so what charts are made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// Texture coordinates: they are the chart.
    Uvs,
    /// Rest positions: charts are computed from the lengths of their edges.
    Rest,
    /// Nothing: charts are computed from the lengths of the frame.
    Nothing,
}
