//! How far apart a pair has to be, so that its distance is no less than the gap in double precision and after rounding
//! to single precision.

use crate::{frame::Frame, mesh::Mesh, proximity::ProximityPair};

/// Rounding to single precision moves a point by half a last place in each coordinate: by `sqrt(3) 2^-24` of its
/// largest coordinate. Two points of two primitives do so; a bit more is asked for.
const SINGLE_ROUNDING: f64 = 2.0 * 1.7321 * 6.0e-8;
/// The part of the gap by which constraints ask for more, since they are satisfied to a small part only.
const SLACK: f64 = 0.03;
/// Pairs up to so many times the gap get constraints as well, so that none of them is pushed below it.
const HORIZON: f64 = 2.0;

/// The distances that a gap asks for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Required {
    gap_m: f64,
    /// Whether positions are stored in single precision, so that they are not rounded again.
    is_stored_single: bool,
    /// The largest coordinate of all vertices.
    largest_m: f64,
}

impl Required {
    pub(super) fn new(mesh: &Mesh, frame: &Frame, gap_m: f64, is_stored_single: bool) -> Self {
        let used = mesh.vertex_ids().filter(|&vertex| !mesh.vertex_faces(vertex).is_empty());
        let largest_m = used.map(|vertex| frame.position(vertex).coords.amax()).fold(0.0, f64::max);
        Self { gap_m, is_stored_single, largest_m }
    }

    /// Pairs below this distance are to be looked at.
    pub(super) fn horizon_m(&self) -> f64 {
        HORIZON * (self.gap_m + self.rounding_m(self.largest_m))
    }

    /// The least distance of a pair that is certainly no nearer than the gap for any reader.
    pub(super) fn least_m(&self, mesh: &Mesh, frame: &Frame, pair: &ProximityPair) -> f64 {
        let vertices = pair.primitives.vertices(mesh);
        let largest_m = vertices.map(|vertex| frame.position(vertex).coords.amax()).fold(0.0, f64::max);
        self.gap_m + self.rounding_m(largest_m)
    }

    /// What constraints ask for.
    pub(super) fn wanted_m(&self, mesh: &Mesh, frame: &Frame, pair: &ProximityPair) -> f64 {
        self.least_m(mesh, frame, pair) + SLACK * self.gap_m
    }

    fn rounding_m(&self, largest_m: f64) -> f64 {
        if self.is_stored_single { 0.0 } else { SINGLE_ROUNDING * largest_m }
    }
}
