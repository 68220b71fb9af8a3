//! The gap that is kept after a tangle came apart: pairs of primitives nearer than `thickness_m` are set apart, along
//! the line of their closest points.
//!
//! A vertex is near to several primitives of the other sheet, and each of these pairs asks for all of its way. So the
//! forces are found in some sweeps (Jacobi): in each a pair gets a part of what is still missing, one that keeps each
//! of its vertices from going farther than the largest way that some pair asks of it. No force pulls, and all are
//! opposite pairs.

use nalgebra::Vector3;

use super::{
    law::{ForceLaw, limited},
    sums::{Forces, mass_kg},
};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    mesh::{Mesh, MeshIdentity, VertexId},
    proximity::{
        ClosestPoints, Primitives, ProximityEnd, ProximityPair, ProximitySearch, SurfaceWays, closest_points_in_order,
        direction_apart,
    },
    settings::Settings,
    sparse_map::SparseMap,
};

/// Pairs up to so many times the thickness are looked at: there the force law ends, whose offset is half the thickness.
const HORIZON: f64 = 1.5;
/// A pair joined along the surface by less than so many times the horizon is near by the shape of the cloth: a bend
/// round a gap of one thickness takes a third of that.
const JOINED: f64 = 2.0;
/// Displacements ask for this part of the thickness more, since they set pairs apart in part only.
const SLACK: f64 = 0.05;
/// No vertex is displaced by more than this part of the distance of its nearest pair: two that meet halfway don't.
const LARGEST_PART: f64 = 0.49;
/// Sweeps over the pairs of a frame.
const NUM_SWEEPS: usize = 4;
/// Most pairs of a frame for each face, and for a small mesh: more are no cloth in layers, and nothing is kept apart.
const MAX_PAIRS_PER_FACE: usize = 32;
const MIN_MAX_PAIRS: usize = 1 << 17;
/// Pairs between two questions whether time is up: about a millisecond.
const PAIRS_BETWEEN_QUESTIONS: usize = 1 << 10;

/// Finds what is nearer than the thickness, and what sets it apart, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Gap {
    search: ProximitySearch,
    found: Vec<ProximityPair>,
    ways: SurfaceWays,
    rest: RestFrame,
    pairs: Vec<GapPair>,
    /// For each vertex of the pairs what they ask of it in one sweep.
    asked: SparseMap<VertexId, Asked>,
    /// For each vertex of any pair how near the nearest is, in metres.
    nearest_m: SparseMap<VertexId, f64>,
    displacements: SparseMap<VertexId, Vector3<f64>>,
}

/// What the pairs of a vertex ask of it, in metres: the largest way, and the sum of all.
#[derive(Clone, Copy, Debug, Default)]
struct Asked {
    largest_m: f64,
    sum_m: f64,
}

/// A pair that is to be set apart.
#[derive(Clone, Copy, Debug)]
struct GapPair {
    primitives: Primitives,
    closest: ClosestPoints,
    /// From the second point to the first.
    direction: Vector3<f64>,
    distance_m: f64,
    /// How far a force of one newton and step^2 sets the two points apart, in metres.
    mobility: f64,
    /// How far it is to be set apart, in metres, and how far one sweep takes it.
    way_m: f64,
    step_m: f64,
    /// The force that does so, in kg m / step^2.
    force: f64,
}

impl Gap {
    /// Finds the pairs that are to be set apart. Those of a vertex that is not free are none, nor those that are
    /// [`JOINED`] along the surface, nor those that no force can move. False, without any, where there are far too many
    /// or time is up.
    ///
    /// Cost: that of [`ProximitySearch::find`], and of a way along the surface for each pair.
    pub(crate) fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        thickness_m: f64,
        is_free: impl Fn(VertexId) -> bool,
        is_spent: &mut dyn FnMut() -> bool,
    ) -> bool {
        let Self { search, found, ways, rest, pairs, nearest_m, .. } = self;
        pairs.clear();
        nearest_m.reset(mesh.num_vertices());
        let horizon_m = HORIZON * thickness_m;
        let max_pairs = MIN_MAX_PAIRS.max(MAX_PAIRS_PER_FACE * mesh.num_faces());
        if is_spent() || search.find(mesh, frame, horizon_m, max_pairs, found) == ProximityEnd::TooManyPairs {
            return false;
        }
        let rest = rest.of(mesh).unwrap_or(frame);
        for (index, &ProximityPair { primitives, distance_m }) in (1..).zip(&*found) {
            if index % PAIRS_BETWEEN_QUESTIONS == 0 && is_spent() {
                pairs.clear();
                return false;
            }
            for vertex in primitives.vertices(mesh) {
                if !nearest_m.insert(vertex, distance_m) {
                    let nearest_m = nearest_m.entry(vertex);
                    *nearest_m = nearest_m.min(distance_m);
                }
            }
            let closest = closest_points_in_order(mesh, frame, primitives);
            if primitives.vertices(mesh).all(&is_free)
                && !ways.may_join_within(mesh, rest, &closest, JOINED * horizon_m)
            {
                pairs.extend(GapPair::new(mesh, frame, primitives, closest));
            }
        }
        // Not by faces, whose order is to change no sum.
        pairs.sort_unstable_by_key(|pair| pair.closest.vertices);
        true
    }

    /// Adds the forces of one step that set pairs apart: by the force law for the way that is missing.
    pub(crate) fn add_forces(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        thickness_m: f64,
        settings: &Settings,
        forces: &mut Forces,
    ) {
        let law = |pair: &GapPair| ForceLaw::new(settings, edge_length_m(frame, pair), 0.0);
        self.solve(mesh, |pair| law(pair).step(thickness_m - pair.distance_m));
        for pair in self.pairs.iter().filter(|pair| pair.force > 0.0) {
            let [own, partner] = points(&pair.closest);
            forces.add_pair(&own, &partner, pair.direction * pair.force, law(pair).largest_m);
        }
    }

    /// The displacements that set pairs apart, ascending by vertex: so short that nothing can meet on the way. Pairs of
    /// a vertex that has a displacement already, by `is_displaced`, are left as they are.
    pub(crate) fn displacements(
        &mut self,
        mesh: &Mesh,
        thickness_m: f64,
        is_displaced: impl Fn(VertexId) -> bool,
    ) -> impl Iterator<Item = (VertexId, Vector3<f64>)> {
        self.solve(mesh, |pair| match pair.primitives.vertices(mesh).any(&is_displaced) {
            true => 0.0,
            false => (1.0 + SLACK) * thickness_m - pair.distance_m,
        });
        self.displacements.sort_keys();
        let Self { displacements, nearest_m, .. } = &*self;
        displacements.keys().iter().map(|&vertex| {
            let largest_m = LARGEST_PART * nearest_m.get(vertex).unwrap_or_default();
            (vertex, limited(displacements.get(vertex).unwrap_or_default(), largest_m))
        })
    }

    /// Finds the forces that set pairs apart by a way each, and the displacements that they make.
    fn solve(&mut self, mesh: &Mesh, way_m: impl Fn(&GapPair) -> f64) {
        self.displacements.reset(mesh.num_vertices());
        for pair in &mut self.pairs {
            (pair.way_m, pair.force) = (way_m(pair), 0.0);
        }
        for _ in 0..NUM_SWEEPS {
            self.ask(mesh);
            for pair in &mut self.pairs {
                let excess = |(vertex, _)| self.asked.get(vertex).unwrap_or_default().excess();
                let part = weighted(&pair.closest).map(excess).fold(1.0, f64::max);
                let force = pair.step_m / (pair.mobility * part);
                pair.force += force;
                for (vertex, weight) in weighted(&pair.closest) {
                    let displacement = pair.direction * (force * weight * inverse_mass(mesh, vertex));
                    *self.displacements.entry(vertex) += displacement;
                }
            }
        }
    }

    /// Notes what is missing of the way of each pair, and what all of them ask of each vertex.
    fn ask(&mut self, mesh: &Mesh) {
        let Self { pairs, asked, displacements, .. } = self;
        asked.reset(mesh.num_vertices());
        for pair in pairs {
            let place = |(vertex, weight)| displacements.get(vertex).unwrap_or_default() * weight;
            let gained_m = pair.direction.dot(&weighted(&pair.closest).map(place).sum());
            pair.step_m = (pair.way_m - gained_m).max(-pair.force * pair.mobility);
            for (vertex, weight) in weighted(&pair.closest) {
                let of_vertex_m = (pair.step_m * weight).abs() * inverse_mass(mesh, vertex) / pair.mobility;
                let asked = asked.entry(vertex);
                asked.largest_m = asked.largest_m.max(of_vertex_m);
                asked.sum_m += of_vertex_m;
            }
        }
    }
}

impl GapPair {
    /// A pair that nothing is asked of yet; nothing where no force moves it, or none has a direction.
    fn new(mesh: &Mesh, frame: &Frame, primitives: Primitives, closest: ClosestPoints) -> Option<Self> {
        let mobility = mobility(mesh, &closest);
        let direction = direction_apart(mesh, frame, primitives, &closest).filter(|_| mobility > 0.0)?;
        let distance_m = closest.offset.norm();
        Some(Self { primitives, closest, direction, distance_m, mobility, way_m: 0.0, step_m: 0.0, force: 0.0 })
    }
}

impl Asked {
    /// How many times the largest way all of them together are.
    fn excess(self) -> f64 {
        if self.largest_m > 0.0 { self.sum_m / self.largest_m } else { 1.0 }
    }
}

/// The rest shape of a mesh as a frame, made once.
#[derive(Debug, Default)]
struct RestFrame {
    identity: Option<MeshIdentity>,
    frame: Option<Frame>,
}

impl RestFrame {
    /// That of a mesh, if it has one.
    fn of(&mut self, mesh: &Mesh) -> Option<&Frame> {
        if self.identity.as_ref() != Some(mesh.identity()) {
            self.identity = Some(mesh.identity().clone());
            self.frame = mesh.rest_positions().and_then(|rest| Frame::new(mesh, rest).ok());
        }
        self.frame.as_ref()
    }
}

/// Both points, as those of faces.
fn points(closest: &ClosestPoints) -> [MaterialPoint; 2] {
    [0, 1].map(|side| MaterialPoint { vertices: closest.vertices[side], weights: closest.weights[side] })
}

/// The vertices of both points, with the weights of the first, and of the second below zero.
fn weighted(closest: &ClosestPoints) -> impl Iterator<Item = (VertexId, f64)> + use<> {
    let ClosestPoints { vertices, weights, .. } = *closest;
    let side = move |side: usize, sign: f64| (0..3).map(move |at| (vertices[side][at], sign * weights[side][at]));
    side(0, 1.0).chain(side(1, -1.0)).filter(|(_, weight)| *weight != 0.0)
}

fn mobility(mesh: &Mesh, closest: &ClosestPoints) -> f64 {
    weighted(closest).map(|(vertex, weight)| weight * weight * inverse_mass(mesh, vertex)).sum()
}

/// One over the mass of a vertex in kilograms; zero where no force moves it: pinned, or without mass.
fn inverse_mass(mesh: &Mesh, vertex: VertexId) -> f64 {
    let mass_kg = mass_kg(mesh, vertex);
    if mesh.is_pinned(vertex) || mass_kg <= 0.0 { 0.0 } else { 1.0 / mass_kg }
}

/// Mean length of the edges of a pair, in metres.
fn edge_length_m(frame: &Frame, GapPair { primitives, closest, .. }: &GapPair) -> f64 {
    let length = |a: VertexId, b: VertexId| (frame.position(a) - frame.position(b)).norm();
    let [[a, b, _], [c, d, e]] = closest.vertices;
    match primitives {
        Primitives::VertexFace { .. } => (length(c, d) + length(d, e) + length(e, c)) / 3.0,
        Primitives::EdgeEdge { .. } => 0.5 * (length(a, b) + length(c, d)),
    }
}
