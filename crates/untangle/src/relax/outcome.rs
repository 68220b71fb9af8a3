//! What a relaxation gives back, and why it ended.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::step::are_faces_pinned;
use crate::{
    frame::FrameError,
    mesh::Mesh,
    paths::{IntersectionPaths, PairType, PathSegment},
};

/// What moved the cloth in an iteration. Where islands of paths took different trials, the one that helped most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Points inside moved to their targets, which a radial basis function fit gave.
    Rbf,
    /// Sheets left each other by the shortest motion, or points inside crossed the corresponding sheet.
    Push,
    /// Paths got shorter, down the gradient of their length.
    Contour,
    /// The flattening flow, where no trial helped, or the shape recovery after it. Named `straighten` in files.
    #[serde(rename = "straighten")]
    Flatten,
    /// Single vertices, or two neighbours, stepped out of what they pierced.
    Nudge,
    /// Primitives that were nearer than the gap were set apart.
    Gap,
    /// Shape recovery: a step towards the rest shape, with nothing left to resolve. Named `settle` in files.
    #[serde(rename = "settle")]
    RecoverShape,
}

/// The state after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Iteration {
    /// Edge-face intersections that are left; those of which all vertices are pinned, and which nothing can change, are
    /// not counted.
    pub num_edge_face_intersections: usize,
    /// World length of all paths in metres, without those among pinned vertices.
    pub path_length_m: f64,
    /// What led here.
    pub method: Method,
    /// Pairs of primitives that are too close, where they are set apart.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_pairs_below: Option<usize>,
}

impl Iteration {
    /// The state after pairs were set apart, of which so many are left.
    pub(super) fn of_gap(num_pairs_below: usize) -> Self {
        Self {
            num_edge_face_intersections: 0,
            path_length_m: 0.0,
            method: Method::Gap,
            num_pairs_below: Some(num_pairs_below),
        }
    }
}

/// A path that could not be resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockedPath {
    /// Its type.
    pub pair_type: PairType,
    /// A vertex beside it, to find it by.
    pub vertex: u32,
    /// World length in metres.
    pub length_m: f64,
    /// Why, in words.
    pub reason: String,
}

/// The best state found, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxation {
    /// Positions in metres, `num_vertices x 3`. Those of the input, bit for bit, if that was clean.
    pub positions: Vec<[f64; 3]>,
    /// One entry for each iteration.
    pub history: Vec<Iteration>,
    /// Paths left in `positions`; empty if none are.
    pub blocked: Vec<BlockedPath>,
    /// Whether the caller ended it, by `progress` or `should_stop`.
    pub interrupted: bool,
}

/// Why positions can't be relaxed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum RelaxError {
    /// Positions were refused.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// Why iterations ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Nothing intersects.
    Clean,
    /// Nothing helps any more.
    Stuck,
    /// The largest number of iterations was reached.
    Exhausted,
    /// The caller asked for it.
    Interrupted,
}

/// What the solver found.
pub(super) struct Solution {
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) history: Vec<Iteration>,
    /// How the last plan ended.
    pub(super) end: End,
    /// Whether there were too many paths for plans of trials.
    pub(super) is_crowded: bool,
    pub(super) interrupted: bool,
}

/// The least tangled state so far.
pub(super) struct BestState {
    pub(super) merit: f64,
    pub(super) positions: Vec<Point3<f64>>,
}

/// The paths of the best state that was found, where the last plan ended so. `crowded` says that there were too many of
/// them for plans of trials.
pub(super) fn blocked_paths(mesh: &Mesh, paths: &IntersectionPaths, end: End, crowded: bool) -> Vec<BlockedPath> {
    let closed = mesh.closed_pieces();
    let pairs = paths.pairs.iter();
    pairs
        .map(|pair| {
            let first = &paths.copies[pair.copies.start];
            let segments = &paths.segments[first.segments.clone()];
            let segment = &segments[0];
            let is_closed = |face| mesh.piece(face).is_some_and(|piece| closed[piece.index()]);
            let is_pinned = |segment: &PathSegment| are_faces_pinned(mesh, [segment.own, segment.partner]);
            let reason = if segments.iter().all(is_pinned) {
                ALL_PINNED
            } else if segments.iter().any(is_pinned) {
                PARTLY_PINNED
            } else if crowded && end == End::Stuck {
                CROWDED
            } else {
                reason(end, is_closed(segment.own) || is_closed(segment.partner))
            };
            let vertex = mesh.face(segment.own)[0].0;
            BlockedPath { pair_type: pair.pair_type, vertex, length_m: pair.length_m, reason: reason.into() }
        })
        .collect()
}

/// Why paths are blocked that no motion can take away.
const ALL_PINNED: &str = "all its vertices are pinned";
/// Why a tangle is given up after the quick plans.
const CROWDED: &str = "too many paths meet here for motions of single ones to help: a crumple, or surfaces that nearly \
                      coincide, of which nothing says which lies outside";
const PARTLY_PINNED: &str = "all vertices of a part of it are pinned";

fn reason(end: End, meets_closed: bool) -> &'static str {
    match (end, meets_closed) {
        (End::Clean, _) => PARTLY_PINNED,
        (End::Exhausted, _) => "the largest number of iterations was reached",
        (End::Interrupted, _) => "the work was ended before it was resolved",
        (End::Stuck, false) => "no motion left it shorter without crushing or overstretching the cloth",
        (End::Stuck, true) => {
            "no motion left it shorter without crushing or overstretching the cloth, \
             and a piece without a boundary can't be drawn flat"
        }
    }
}
