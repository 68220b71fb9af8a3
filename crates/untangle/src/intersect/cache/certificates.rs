//! The certificates of a mesh, and when to use or rebuild them.

use nalgebra::Point3;

use super::{
    clocks::Clocks,
    displacements::{Displacements, ROUNDING},
};
use crate::{
    frame::{BodyVersion, Frame},
    intersect::{
        bvh::{Bvh, WIDTH},
        filter::OneRings,
    },
    mesh::Mesh,
};

/// Leaves that share a clock.
const LEAVES_PER_CLOCK: usize = 8;

/// Vertex stars that share a clock, and are passed over together while none has expired.
pub(in crate::intersect) const STARS_PER_GROUP: usize = 32;

/// Pairs of leaves that are passed over together while none has expired.
pub(in crate::intersect) const PAIRS_PER_GROUP: usize = 32;

/// How the next frame is to be searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::intersect) enum Mode {
    /// Search everything, keep no certificates: displacements are so large that they would expire at once.
    Cold,
    /// Search everything and issue certificates.
    Rebuild,
    /// Search only where certificates have expired.
    Cached,
}

/// Certificate that the faces of two leaves are separated, the first leaf not after the second.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct Certificate {
    pub(in crate::intersect) leaves: [u32; 2],
    /// The sum of the leaves' clocks at which it expires, in metres; [`NEVER_TESTED`] or [`TOUCHING`] without
    /// separation.
    pub(in crate::intersect) expires_m: f64,
}

/// More than the rounding of two coordinates to single precision, relative to the extent of a frame, which may have
/// doubled since.
const RESOLUTION: f64 = 1e-6;

/// The expiry of a pair that no frame has tested yet.
pub(super) const NEVER_TESTED: f64 = f64::NEG_INFINITY;

/// The expiry of what the last test did not find separated.
pub(super) const TOUCHING: f64 = 0.0;

/// All certificates, and the clocks by which they expire.
#[derive(Debug, Default)]
pub(in crate::intersect) struct CertificateCache {
    leaf_clocks: Clocks,
    star_clocks: Clocks,
    previous: Vec<Point3<f64>>,
    /// Where bodies were then.
    body: BodyVersion,
    displacements: Displacements,
    /// Leaves without a certificate were further apart than this, in metres, when all clocks stood at zero; zero if
    /// nothing is cached.
    margin_m: f64,
    /// How far apart boxes may be, in metres, that overlap in the single precision of a cold search.
    resolution_m: f64,
    pub(in crate::intersect) pairs: Vec<Certificate>,
    /// For each [`PAIRS_PER_GROUP`] of them the first expiry.
    pair_groups_m: Vec<f64>,
    /// For each vertex star when its certificate expires.
    stars_m: Vec<f64>,
    /// For each [`STARS_PER_GROUP`] of them the first expiry.
    star_groups_m: Vec<f64>,
}

/// The parts of the cache that a search works on.
pub(in crate::intersect) struct CertificatesMut<'a> {
    pub(in crate::intersect) leaf_times_m: &'a [f64],
    /// No leaf's clock has advanced further.
    pub(in crate::intersect) latest_m: f64,
    pub(in crate::intersect) pairs: &'a mut [Certificate],
    pub(in crate::intersect) pair_groups_m: &'a mut [f64],
    pub(in crate::intersect) star_times_m: &'a [f64],
    pub(in crate::intersect) stars_m: &'a mut [f64],
    pub(in crate::intersect) star_groups_m: &'a mut [f64],
}

impl CertificateCache {
    /// Starts over with another tree.
    pub(in crate::intersect) fn reset(&mut self, mesh: &Mesh, bvh: &Bvh, one_rings: &OneRings) {
        *self = Self::default();
        let mut vertices = Vec::new();
        for faces in bvh.all_corners().chunks(WIDTH * LEAVES_PER_CLOCK) {
            vertices.extend(faces.iter().flatten());
            self.leaf_clocks.push(mesh, &mut vertices);
        }
        for first in (0..one_rings.len()).step_by(STARS_PER_GROUP) {
            for ring in first..(first + STARS_PER_GROUP).min(one_rings.len()) {
                let ring = one_rings.get(ring);
                vertices.push(ring.centre);
                vertices.extend(ring.around);
            }
            self.star_clocks.push(mesh, &mut vertices);
        }
        self.stars_m.resize(one_rings.len(), TOUCHING);
        self.star_groups_m.resize(one_rings.len().div_ceil(STARS_PER_GROUP), TOUCHING);
    }

    /// Drops the last frame and all certificates.
    pub(in crate::intersect) fn clear(&mut self) {
        self.previous.clear();
        self.margin_m = 0.0;
    }

    /// Within how many metres leaves get a certificate.
    pub(in crate::intersect) fn margin_m(&self) -> f64 {
        self.margin_m
    }

    /// Advances the clocks to the next frame and says how to search it.
    pub(in crate::intersect) fn advance(&mut self, mesh: &Mesh, frame: &Frame) -> Mode {
        let positions = frame.positions();
        let are_bodies_still = frame.body_version().is_still(std::mem::replace(&mut self.body, frame.body_version()));
        if self.previous.len() != positions.len() {
            self.previous.clear();
            self.previous.extend_from_slice(positions);
            self.displacements.resize(positions.len());
            self.margin_m = 0.0;
            return Mode::Cold;
        }
        let longest = self.displacements.measure(mesh, &mut self.previous, positions, are_bodies_still);
        if self.margin_m > 0.0 {
            self.leaf_clocks.advance(&self.displacements);
            self.star_clocks.advance(&self.displacements);
            if 2.0 * self.leaf_clocks.latest_m() + self.resolution_m < self.margin_m {
                return Mode::Cached;
            }
        }
        // A wider margin costs more in the search and lets certificates last longer.
        let length = sampled_edge_length(mesh, frame);
        let is_slow = length.is_finite() && longest * 64.0 <= length;
        self.margin_m = if is_slow { (64.0 * longest).clamp(length / 16.0, length / 2.0) } else { 0.0 };
        if self.margin_m <= 0.0 {
            return Mode::Cold;
        }
        self.expire_all();
        Mode::Rebuild
    }

    /// Goes on with the leaf pairs of a frame whose largest extent is `1 / scale` metres, if they are `all` of them;
    /// without certificates otherwise. While there are certificates, every pair of faces without a common vertex that a
    /// cold search would test lies in one of the pairs of leaves.
    pub(in crate::intersect) fn keep_pairs(&mut self, all: bool, scale: f64) -> bool {
        self.resolution_m = 4.0 * RESOLUTION / scale;
        if !(all && self.resolution_m < self.margin_m) {
            self.pairs.clear();
            self.margin_m = 0.0;
            return false;
        }
        true
    }

    fn expire_all(&mut self) {
        self.leaf_clocks.reset();
        self.star_clocks.reset();
        self.pairs.clear();
        self.pair_groups_m.clear();
        self.stars_m.fill(TOUCHING);
        self.star_groups_m.fill(TOUCHING);
    }

    /// All of it, in the order in which the search goes through it.
    pub(in crate::intersect) fn certificates_mut(&mut self) -> CertificatesMut<'_> {
        // Groups that are new hold pairs that were never tested.
        self.pair_groups_m.resize(self.pairs.len().div_ceil(PAIRS_PER_GROUP), NEVER_TESTED);
        CertificatesMut {
            latest_m: self.leaf_clocks.latest_m(),
            leaf_times_m: self.leaf_clocks.times_m(),
            pairs: &mut self.pairs,
            pair_groups_m: &mut self.pair_groups_m,
            star_times_m: self.star_clocks.times_m(),
            stars_m: &mut self.stars_m,
            star_groups_m: &mut self.star_groups_m,
        }
    }
}

/// The clocks of two leaves together.
#[inline(always)]
pub(super) fn pair_time_m(leaf_times_m: &[f64], leaves: [u32; 2]) -> f64 {
    let [a, b] = leaves.map(|leaf| leaf_times_m[leaf as usize / LEAVES_PER_CLOCK]);
    a + b
}

/// The expiry of a certificate that is issued now and lasts for `clearance_m`.
#[inline(always)]
pub(super) fn expiry_m(now_m: f64, clearance_m: f64) -> f64 {
    if clearance_m > 0.0 { (now_m + clearance_m) * (1.0 - ROUNDING) } else { TOUCHING }
}

/// Mean length of some 512 edges, in metres: it only chooses a margin.
fn sampled_edge_length(mesh: &Mesh, frame: &Frame) -> f64 {
    let stride = mesh.num_edges() / 512 + 1;
    let (mut sum, mut count) = (0.0, 0.0);
    for edge in mesh.edge_ids().step_by(stride) {
        let [a, b] = mesh.edge(edge).map(|vertex| frame.position(vertex));
        sum += (b - a).norm();
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
