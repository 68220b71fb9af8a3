//! The library's answers, held against those in rational numbers.

use std::collections::BTreeSet;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector, do_intersect},
    mesh::{FaceId, Mesh, MeshDescription, VertexId},
    predicates::{Side, Site, side_of_plane},
    proximity::{Primitives, ProximityEnd, ProximitySearch},
};

use super::{
    gap::{edges_squared, vertex_squared},
    number::{Fraction, fraction},
    surface::{Found, Surface},
};

/// What rounding may add to a distance, in the unit of [`Compared::largest_error`]: 1e-6 of the extent, for slivers.
const MAX_ERROR: f64 = 1e10;

/// What was compared, and found alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compared {
    /// Frames that both refused.
    pub num_refused: usize,
    /// Pairs of faces, or of primitives.
    pub num_pairs: usize,
    /// Those that intersect, or decisions that were "nearer".
    pub num_positive: usize,
    /// Signs of four vertices, or decisions at a distance.
    pub num_decisions: usize,
    /// The largest error of a distance that the library gave, in units of 2^-53 of the largest difference of two
    /// coordinates of its primitives.
    pub largest_error: f64,
}

impl Compared {
    /// Both together.
    pub fn add(&mut self, other: &Self) {
        self.num_refused += other.num_refused;
        self.num_pairs += other.num_pairs;
        self.num_positive += other.num_positive;
        self.num_decisions += other.num_decisions;
        self.largest_error = self.largest_error.max(other.largest_error);
    }
}

/// A mesh of faces, some of bodies.
fn mesh(num_vertices: usize, faces: &[[u32; 3]], body: &[u32]) -> Mesh {
    let description =
        MeshDescription { num_vertices, faces: faces.to_vec(), body: body.to_vec(), ..MeshDescription::default() };
    Mesh::new(description).unwrap()
}

/// Compares all intersections of some frames of a mesh, searched one after the other with one memory, and the sign of
/// every four vertices.
///
/// # Errors
/// What differs, in words.
pub(super) fn compare_intersections(
    faces: &[[u32; 3]],
    body: &[u32],
    frames: &[Vec<[f64; 3]>],
) -> Result<Compared, String> {
    let mesh = mesh(frames[0].len(), faces, body);
    let mut compared = Compared::default();
    let mut search = Intersector::default();
    for positions in frames {
        let judge = Surface::new(positions, faces, body);
        let (judge, frame) = match (judge, Frame::new(&mesh, positions)) {
            (Some(judge), Ok(frame)) => (judge, frame),
            (None, Err(_)) => {
                compared.num_refused += 1;
                continue;
            }
            (judge, frame) => return Err(format!("accepted: {}, by the library: {}", judge.is_some(), frame.is_ok())),
        };
        let mut found = Intersections::default();
        search.intersect(&mesh, &frame, &mut found);
        let expected = judge.intersections();
        let found = named(&mesh, &found);
        if found != expected {
            return Err(format!("intersections {found:?}, expected {expected:?}"));
        }
        compared.num_positive += expected.faces.len();
        compared.num_pairs += compare_pairs(&mesh, &frame, &judge, &expected)?;
        compared.num_decisions += compare_signs(&frame, &judge)?;
    }
    Ok(compared)
}

/// What was found by the names that the judge has for it.
fn named(mesh: &Mesh, found: &Intersections) -> Found {
    let edge = |edge| {
        let [a, b] = mesh.edge(edge);
        [a.0.min(b.0), a.0.max(b.0)]
    };
    Found {
        piercings: found.edge_face.iter().map(|hit| (edge(hit.edge), hit.face.0 as usize)).collect(),
        faces: found.segments.iter().map(|segment| segment.faces.map(|face| face.0 as usize)).collect(),
    }
}

/// Every pair of faces by itself.
fn compare_pairs(mesh: &Mesh, frame: &Frame, judge: &Surface, expected: &Found) -> Result<usize, String> {
    let mut num_pairs = 0;
    for (first, a) in judge.faces() {
        for (second, b) in judge.faces().filter(|&(second, b)| second > first && !judge.are_bodies(a[0], b[0])) {
            let pair = [first, second];
            if do_intersect(mesh, frame, pair.map(|face| FaceId(face as u32))) != expected.faces.contains(&pair) {
                return Err(format!("faces {a:?} and {b:?} alone"));
            }
            num_pairs += 1;
        }
    }
    Ok(num_pairs)
}

/// The sign of every four vertices, in three orders.
fn compare_signs(frame: &Frame, judge: &Surface) -> Result<usize, String> {
    let count = (judge.points().len() as u32).min(10);
    let site = |index: u32| Site { position: frame.position(VertexId(index)).into(), index };
    let mut num_signs = 0;
    for [a, b, c, d] in
        (0..count).flat_map(|a| (0..a).flat_map(move |b| (0..b).flat_map(move |c| (0..c).map(move |d| [a, b, c, d]))))
    {
        for order in [[a, b, c, d], [c, a, d, b], [d, b, a, c]] {
            let [p, q, r, s] = order.map(site);
            if (side_of_plane(p, q, r, s) == Side::Above) != judge.sign(order) {
                return Err(format!("the sign of vertices {order:?}"));
            }
            num_signs += 1;
        }
    }
    Ok(num_signs)
}

/// Compares the distances of all primitives of a frame that have no common vertex: each decision at distances next to
/// the distance itself, the search for all pairs nearer than some of these, the nearest pair, and the distances that
/// are given.
///
/// # Errors
/// What differs, in words.
pub(super) fn compare_gaps(faces: &[[u32; 3]], body: &[u32], positions: &[[f64; 3]]) -> Result<Compared, String> {
    let mesh = mesh(positions.len(), faces, body);
    let mut compared = Compared::default();
    let (Some(judge), Ok(frame)) = (Surface::new(positions, faces, body), Frame::new(&mesh, positions)) else {
        return Ok(compared);
    };
    let pairs = all_pairs(&mesh, &judge);
    for (primitives, squared) in &pairs {
        let distance = root(squared);
        for distance_m in [distance.next_down(), distance, distance.next_up(), 1.0, 0.5 * distance, 2.0 * distance] {
            if distance_m <= 0.0 {
                continue;
            }
            let is_nearer = is_nearer(squared, distance_m);
            if primitives.are_nearer(&mesh, &frame, distance_m) != is_nearer {
                return Err(format!("{primitives:?} nearer than {distance_m:e}: expected {is_nearer}"));
            }
            compared.num_decisions += 1;
            compared.num_positive += usize::from(is_nearer);
        }
        let error = error_of(primitives.distance_m(&mesh, &frame), squared, extent(&mesh, &frame, *primitives));
        compared.largest_error = compared.largest_error.max(error);
        if error > MAX_ERROR {
            let distance_m = primitives.distance_m(&mesh, &frame);
            return Err(format!("{primitives:?} at {distance_m:e}, expected {distance:e}: off by {error:e} units"));
        }
    }
    compared.num_pairs = pairs.len();
    compare_searches(&mesh, &frame, &pairs)?;
    Ok(compared)
}

/// The search for all pairs below a distance, and for the nearest one.
fn compare_searches(mesh: &Mesh, frame: &Frame, pairs: &[(Primitives, Fraction)]) -> Result<(), String> {
    let mut search = ProximitySearch::default();
    let mut sorted: Vec<&Fraction> = pairs.iter().map(|(_, squared)| squared).collect();
    sorted.sort_unstable();
    for part in [sorted.len() / 8, sorted.len() / 2] {
        let distance_m = root(sorted.get(part).copied().unwrap_or(&Fraction::ONE)).next_up();
        let mut found = Vec::new();
        let end = search.find(mesh, frame, distance_m, usize::MAX, &mut found);
        let expected: BTreeSet<Primitives> =
            pairs.iter().filter(|(_, squared)| is_nearer(squared, distance_m)).map(|(pair, _)| *pair).collect();
        let listed: BTreeSet<Primitives> = found.iter().map(|pair| pair.primitives).collect();
        if end != ProximityEnd::Complete || listed.len() != found.len() || listed != expected {
            let (missing, more) = (expected.difference(&listed), listed.difference(&expected));
            let words = [missing.collect::<Vec<_>>(), more.collect::<Vec<_>>()];
            return Err(format!("pairs nearer than {distance_m:e}: missing and too many: {words:?}"));
        }
    }
    match (search.nearest(mesh, frame), sorted.first()) {
        (None, None) => Ok(()),
        (Some(pair), Some(squared)) => {
            // Not farther than the right one, but for what rounds either.
            let right = pairs.iter().find(|(_, own)| own == *squared).map(|(primitives, _)| *primitives);
            let extents = [Some(pair.primitives), right].map(|of| of.map_or(0.0, |of| extent(mesh, frame, of)));
            let error = error_of(pair.distance_m, squared, extents[0].max(extents[1]));
            if error <= MAX_ERROR { Ok(()) } else { Err(format!("nearest {pair:?}, off by {error:.1} units")) }
        }
        (nearest, _) => Err(format!("nearest {nearest:?} of {} pairs", pairs.len())),
    }
}

/// All pairs of primitives without a common vertex, with their squared distances.
pub(super) fn all_pairs(mesh: &Mesh, judge: &Surface) -> Vec<(Primitives, Fraction)> {
    let at = |vertex: u32| &judge.points()[vertex as usize];
    let mut pairs = Vec::new();
    let used: BTreeSet<u32> = judge.faces().flat_map(|(_, corners)| corners).collect();
    for (number, corners) in judge.faces() {
        for &vertex in used.iter().filter(|&&vertex| !corners.contains(&vertex)) {
            if !judge.are_bodies(vertex, corners[0]) {
                let primitives = Primitives::VertexFace { vertex: VertexId(vertex), face: FaceId(number as u32) };
                pairs.push((primitives, vertex_squared(at(vertex), corners.map(at))));
            }
        }
    }
    let edges: Vec<[u32; 2]> = judge.edges().into_iter().collect();
    for (number, &first) in edges.iter().enumerate() {
        for &second in &edges[number + 1..] {
            if !first.iter().any(|end| second.contains(end)) && !judge.are_bodies(first[0], second[0]) {
                let [a, b] = [first, second].map(|[p, q]| mesh.edge_between(VertexId(p), VertexId(q)).unwrap());
                let squared = edges_squared(first.map(at), second.map(at));
                pairs.push((Primitives::EdgeEdge { edges: [a.min(b), a.max(b)] }, squared));
            }
        }
    }
    pairs
}

pub(super) fn is_nearer(squared: &Fraction, distance: f64) -> bool {
    let distance = fraction(distance);
    *squared < &distance * &distance
}

/// The root of a fraction, nearly.
pub(super) fn root(squared: &Fraction) -> f64 {
    squared.to_f64().value().sqrt()
}

/// The largest difference of two coordinates of a pair of primitives.
fn extent(mesh: &Mesh, frame: &Frame, primitives: Primitives) -> f64 {
    let places: Vec<[f64; 3]> = primitives.vertices(mesh).map(|vertex| frame.position(vertex).into()).collect();
    let along = |axis: usize| {
        let values = places.iter().map(|place| place[axis]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    (0..3).map(along).fold(0.0, f64::max)
}

/// How far a distance is off, in units of 2^-53 of an extent.
fn error_of(distance: f64, squared: &Fraction, extent: f64) -> f64 {
    let off = (distance - root(squared)).abs();
    if off > 0.0 { off / (0.5 * f64::EPSILON * extent) } else { 0.0 }
}
