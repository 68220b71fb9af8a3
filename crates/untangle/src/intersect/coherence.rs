//! What a proof of one frame says about the next ones.
//!
//! Two faces whose distance is `d` do not meet for as long as they have moved by less than `d` together, whatever way they took; the same holds, with a
//! bound of its own, for the faces round a vertex. So every proof gets a time until which it holds, where time is measured by clocks that
//! run as vertices move: the clock of a set of vertices goes forward, each frame, by the longest step in it. What has run out is proven, or tested
//! exactly, anew. A motion that all vertices share moves nothing apart or together and is left out.
//!
//! Rounding: clocks are rounded forward, times back. The answers are those of a search from nothing.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{boxes::WIDTH, broad::FaceTree};
use crate::{
    frame::Frame,
    mesh::{Mesh, VertexId},
};

/// Leaves that share a clock.
const LEAVES_OF_REGION: usize = 8;

/// Rings that share a clock.
pub(crate) const RINGS_OF_GROUP: usize = 32;

/// Pairs of leaves that are passed over together.
pub(crate) const PAIRS_OF_GROUP: usize = 32;

/// Sets or vertices that one thread takes in one go, at least.
const LEAST_SHARE: usize = 1024;

/// More than the relative rounding of the three or four operations after which it is applied.
pub(crate) const ROUNDING: f64 = 1e-15;

/// How the next frame is to be searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// From nothing, and nothing is kept.
    Cold,
    /// From nothing, with proofs that last.
    Anew,
    /// Only what has run out.
    Kept,
}

/// Two leaves, the first not after the second, and the time until which their faces are known not to meet: [`NEVER_SEEN`], or [`TOUCHING`]
/// where nothing was known the last time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafPair {
    pub(crate) leaves: [u32; 2],
    pub(crate) until: f64,
}

pub(crate) const NEVER_SEEN: f64 = f64::NEG_INFINITY;
pub(crate) const TOUCHING: f64 = 0.0;

/// Sets of vertices, each with its clock.
#[derive(Debug, Default)]
struct Sets {
    offsets: Vec<u32>,
    vertices: Vec<VertexId>,
    clocks: Vec<f64>,
}

impl Sets {
    fn push(&mut self, vertices: &mut Vec<VertexId>) {
        vertices.sort_unstable();
        vertices.dedup();
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.vertices.append(vertices);
        self.offsets.push(u32::try_from(self.vertices.len()).expect("fewer than three for each face"));
        self.clocks.push(0.0);
    }

    fn advance(&mut self, steps: &Steps) {
        let (offsets, vertices) = (&self.offsets, &self.vertices);
        self.clocks.par_iter_mut().with_min_len(LEAST_SHARE / 8).enumerate().for_each(|(set, clock)| {
            let of_set = &vertices[offsets[set] as usize..offsets[set + 1] as usize];
            let longest = of_set.iter().fold(0.0, |longest, vertex| {
                let square = steps.squares[vertex.index()];
                if square > longest { square } else { longest }
            });
            *clock = (*clock + steps.bound_m(longest)) * (1.0 + ROUNDING);
        });
    }

    fn latest(&self) -> f64 {
        self.clocks.iter().copied().fold(0.0, f64::max)
    }
}

/// How far vertices moved from one frame to the next, but for a motion that all share.
#[derive(Debug, Default)]
struct Steps {
    /// For each vertex the square of its step in square metres.
    squares: Vec<f64>,
    /// The longest motion with the common one, in metres: what rounding of a step goes by.
    farthest_m: f64,
}

impl Steps {
    /// A bound of a step with this square. Squares that vanish are below 1e-160 metres.
    fn bound_m(&self, square: f64) -> f64 {
        square.sqrt() * (1.0 + ROUNDING) + ROUNDING * self.farthest_m + 1e-150
    }

    /// Measures the steps from `previous`, which become `positions`; a bound of the longest of them, in metres.
    fn measure(&mut self, previous: &mut [Point3<f64>], positions: &[Point3<f64>]) -> f64 {
        // Any common motion will do; the mean of some is close to the best one.
        let stride = positions.len() / 512 + 1;
        let samples = positions.iter().zip(&*previous).step_by(stride);
        let (sum, count) =
            samples.fold((Vector3::zeros(), 0.0), |(sum, count), (now, before)| (sum + (now - before), count + 1.0));
        let common: Vector3<f64> = if count > 0.0 { sum / count } else { sum };
        let squares = self.squares.par_chunks_mut(LEAST_SHARE);
        let shares = squares.zip(previous.par_chunks_mut(LEAST_SHARE)).zip(positions.par_chunks(LEAST_SHARE));
        let of_shares = shares.map(|((squares, previous), positions)| {
            let (mut longest, mut farthest) = (0.0, 0.0);
            for ((square, before), now) in squares.iter_mut().zip(previous).zip(positions) {
                let moved = now - *before;
                let apart = moved - common;
                *square = apart.dot(&apart);
                *before = *now;
                let far = moved.x.abs() + moved.y.abs() + moved.z.abs();
                longest = if *square > longest { *square } else { longest };
                farthest = if far > farthest { far } else { farthest };
            }
            (longest, farthest)
        });
        let (longest, farthest) = of_shares.reduce(|| (0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
        self.farthest_m = farthest;
        self.bound_m(longest)
    }
}

/// The clocks, and the proofs that run by them.
#[derive(Debug, Default)]
pub(crate) struct Coherence {
    regions: Sets,
    groups: Sets,
    previous: Vec<Point3<f64>>,
    steps: Steps,
    /// Leaves that are not listed in `pairs` are further apart than this, in metres, from when all clocks stood at zero; zero if nothing is kept.
    margin_m: f64,
    pub(crate) pairs: Vec<LeafPair>,
    /// For each [`PAIRS_OF_GROUP`] of them when the first proof runs out.
    first_of_pairs: Vec<f64>,
    /// For each ring of the tree.
    rings_until: Vec<f64>,
    /// For each [`RINGS_OF_GROUP`] of them when the first proof runs out.
    first_of_rings: Vec<f64>,
}

/// The clocks of regions and of groups of rings, and the proofs that run by each.
pub(crate) struct Parts<'a> {
    pub(crate) regions: &'a [f64],
    /// No region's clock has gone further.
    pub(crate) latest: f64,
    pub(crate) pairs: &'a mut [LeafPair],
    pub(crate) first_of_pairs: &'a mut [f64],
    pub(crate) groups: &'a [f64],
    pub(crate) rings_until: &'a mut [f64],
    pub(crate) first_of_rings: &'a mut [f64],
}

impl Coherence {
    /// Starts from nothing with another tree.
    pub(crate) fn reset(&mut self, tree: &FaceTree) {
        *self = Self::default();
        let mut vertices = Vec::new();
        for faces in tree.all_corners().chunks(WIDTH * LEAVES_OF_REGION) {
            vertices.extend(faces.iter().flatten());
            self.regions.push(&mut vertices);
        }
        for first in (0..tree.rings().len()).step_by(RINGS_OF_GROUP) {
            for ring in first..(first + RINGS_OF_GROUP).min(tree.rings().len()) {
                let ring = tree.rings().get(ring);
                vertices.push(ring.centre);
                vertices.extend(ring.around);
            }
            self.groups.push(&mut vertices);
        }
        self.rings_until.resize(tree.rings().len(), TOUCHING);
        self.first_of_rings.resize(tree.rings().len().div_ceil(RINGS_OF_GROUP), TOUCHING);
    }

    /// Forgets the last frame.
    pub(crate) fn forget(&mut self) {
        self.previous.clear();
        self.margin_m = 0.0;
    }

    /// How far leaves look for others.
    pub(crate) fn margin_m(&self) -> f64 {
        self.margin_m
    }

    /// Runs the clocks to the next frame and says how to search it.
    pub(crate) fn advance(&mut self, mesh: &Mesh, frame: &Frame) -> Mode {
        let positions = frame.positions();
        if self.previous.len() != positions.len() {
            self.previous.clear();
            self.previous.extend_from_slice(positions);
            self.steps.squares.resize(positions.len(), 0.0);
            self.margin_m = 0.0;
            return Mode::Cold;
        }
        let longest = self.steps.measure(&mut self.previous, positions);
        if self.margin_m > 0.0 {
            self.regions.advance(&self.steps);
            self.groups.advance(&self.steps);
            if 2.0 * self.regions.latest() < self.margin_m {
                return Mode::Kept;
            }
            self.margin_m = 0.0;
        }
        // The wider the margin, the dearer the search and the longer its proofs last.
        let length = mean_edge_length(mesh, frame);
        if longest * 64.0 > length || !length.is_finite() {
            return Mode::Cold;
        }
        self.margin_m = (64.0 * longest).clamp(length / 16.0, length / 2.0);
        if self.margin_m <= 0.0 {
            return Mode::Cold;
        }
        for sets in [&mut self.regions, &mut self.groups] {
            sets.clocks.fill(0.0);
        }
        self.pairs.clear();
        self.first_of_pairs.clear();
        self.rings_until.fill(TOUCHING);
        self.first_of_rings.fill(TOUCHING);
        Mode::Anew
    }

    /// The clocks of two leaves together.
    #[inline(always)]
    pub(crate) fn time_of(clocks: &[f64], leaves: [u32; 2]) -> f64 {
        let [a, b] = leaves.map(|leaf| clocks[leaf as usize / LEAVES_OF_REGION]);
        a + b
    }

    /// All of it, in the order in which the search goes through it.
    pub(crate) fn parts(&mut self) -> Parts<'_> {
        // Of pairs that were never seen the first time is long past.
        self.first_of_pairs.resize(self.pairs.len().div_ceil(PAIRS_OF_GROUP), NEVER_SEEN);
        Parts {
            latest: self.regions.latest(),
            regions: &self.regions.clocks,
            pairs: &mut self.pairs,
            first_of_pairs: &mut self.first_of_pairs,
            groups: &self.groups.clocks,
            rings_until: &mut self.rings_until,
            first_of_rings: &mut self.first_of_rings,
        }
    }
}

/// The time until which a proof holds that lasts for `span` from `now` on.
#[inline(always)]
pub(crate) fn until(now: f64, span: f64) -> f64 {
    if span > 0.0 { (now + span) * (1.0 - ROUNDING) } else { TOUCHING }
}

/// From some edges: it only chooses a margin.
fn mean_edge_length(mesh: &Mesh, frame: &Frame) -> f64 {
    let stride = mesh.num_edges() / 512 + 1;
    let (mut sum, mut count) = (0.0, 0.0);
    for edge in mesh.edge_ids().step_by(stride) {
        let [a, b] = mesh.edge(edge).map(|vertex| frame.position(vertex));
        sum += (b - a).norm();
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
