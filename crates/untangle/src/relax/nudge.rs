//! What is left of a tangle where a displacement of whole sheets does not help: single vertices step to the other side
//! of what they pierce, or two neighbours together. A hem that folded over by a vertex is such a place: its faces have
//! vertices in common, and can't be shifted against each other.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{
    escape::ShapeLimits,
    outcome::{BestState, End, Method, RelaxError},
    relaxer::{Progress, Relaxer},
    step::{num_movable, stored, total},
};
use crate::{
    frame::Frame,
    geometry::mean_edge_length,
    intersect::{Intersections, do_intersect},
    mesh::{FaceId, Mesh, VertexId},
};

/// More edge-face intersections than this are for whole sheets.
const FEW: usize = 32;
/// Most vertices that step.
const MAX_STEPS: usize = 32;
/// Lengths of steps, in mean edge lengths of the vertex.
const LENGTHS: [f64; 7] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
/// Pairs of faces by which directions are found, for each vertex.
const MAX_PAIRS: usize = 4;
/// A little wider than those of the descent: few edges are concerned, and recovery follows.
const LIMITS: ShapeLimits = ShapeLimits { max_stretch: 1.6, min_area: 0.1 };

/// A displacement of a vertex, or of two neighbours.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// The same one twice where it steps alone.
    vertices: [VertexId; 2],
    displacement: Vector3<f64>,
    /// By how many fewer pairs of faces intersect.
    gain: usize,
    /// In mean edge lengths of the vertices.
    length: f64,
}

/// Steps single vertices from the best state, as long as that leaves it less tangled and within limits of strain.
///
/// Cost: for each step some thousand tests of the faces of a vertex with those near it, for each vertex of what
/// intersects, in parallel; and an analysis.
pub(super) fn nudge(
    relaxer: &mut Relaxer<'_>,
    best: &mut BestState,
    progress: &mut Progress<'_>,
) -> Result<End, RelaxError> {
    relaxer.set_frame(&best.positions)?;
    let mut held = BTreeSet::new();
    for _ in 0..MAX_STEPS {
        let found = &relaxer.analyser.last().intersections;
        if relaxer.is_clean() {
            return Ok(End::Clean);
        }
        if num_movable(relaxer.mesh, found) > FEW {
            break;
        }
        if relaxer.is_exhausted() {
            return Ok(End::Exhausted);
        }
        if (relaxer.should_stop)() {
            return Ok(End::Interrupted);
        }
        let Some(step) = best_step(relaxer, found, &held) else { break };
        let mut positions = relaxer.frame.positions().to_vec();
        for vertex in step.vertices {
            let from = relaxer.frame.position(vertex);
            positions[vertex.index()] = stored(from + step.displacement, relaxer.settings.single_precision);
        }
        relaxer.set_frame(&positions)?;
        relaxer.measure_islands(0);
        let merit = total(&relaxer.now).merit();
        if merit < best.merit {
            *best = BestState { merit, positions };
            if relaxer.report(Method::Push, progress).is_break() {
                return Ok(End::Interrupted);
            }
        } else {
            // It is on the wrong side there, or worse elsewhere.
            held.insert(step.vertices[0]);
            relaxer.set_frame(&best.positions)?;
        }
    }
    Ok(if relaxer.is_clean() { End::Clean } else { End::Stuck })
}

/// The step that helps most, the shortest of equals, of all vertices of what intersects that are free and not `held`.
fn best_step(relaxer: &Relaxer<'_>, found: &Intersections, held: &BTreeSet<VertexId>) -> Option<Step> {
    let mesh = relaxer.mesh;
    let corners = found.segments.iter().flat_map(|segment| segment.faces).flat_map(|face| mesh.face(face));
    let vertices: BTreeSet<VertexId> =
        corners.filter(|vertex| !mesh.is_pinned(*vertex) && !held.contains(vertex)).collect();
    let vertices: Vec<VertexId> = vertices.into_iter().collect();
    let steps: Vec<Option<Step>> = vertices.par_iter().map(|&vertex| best_of_vertex(relaxer, vertex)).collect();
    steps.into_iter().flatten().min_by(|a, b| b.gain.cmp(&a.gain).then(a.length.total_cmp(&b.length)))
}

/// The step of a vertex that helps most; with a neighbour only where alone it does not resolve all that it meets.
fn best_of_vertex(relaxer: &Relaxer<'_>, vertex: VertexId) -> Option<Step> {
    let mesh = relaxer.mesh;
    let alone = Surroundings::of(relaxer, [vertex; 2]);
    let num_pairs = alone.pairs(mesh, &relaxer.frame, usize::MAX).len();
    let mut best = alone.best_step(relaxer);
    let neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
    for other in neighbours.filter(|other| !mesh.is_pinned(*other)) {
        if best.is_some_and(|best| best.gain >= num_pairs) {
            break;
        }
        let step = Surroundings::of(relaxer, [vertex, other]).best_step(relaxer);
        if step.map_or(0, |step| step.gain) > best.map_or(0, |best| best.gain) {
            best = step;
        }
    }
    best
}

/// One vertex or two with their faces, and those that these can reach.
struct Surroundings {
    vertices: [VertexId; 2],
    edge_m: f64,
    star: Vec<FaceId>,
    near: Vec<FaceId>,
}

impl Surroundings {
    fn of(relaxer: &Relaxer<'_>, vertices: [VertexId; 2]) -> Self {
        let Relaxer { mesh, frame, .. } = relaxer;
        let star: BTreeSet<FaceId> = vertices.iter().flat_map(|&vertex| mesh.vertex_faces(vertex)).copied().collect();
        let edge_m = mean_edge_length(mesh, frame, star.iter().copied()).unwrap_or(0.0);
        let (low, high) = extent(star.iter().flat_map(|&face| mesh.face(face)).map(|corner| frame.position(corner)));
        let reach = Vector3::repeat(LENGTHS[LENGTHS.len() - 1] * edge_m);
        let (low, high) = (low - reach, high + reach);
        let is_near = |face: &FaceId| {
            let (own_low, own_high) = extent(mesh.face(*face).into_iter().map(|corner| frame.position(corner)));
            (0..3).all(|axis| own_low[axis] <= high[axis] && low[axis] <= own_high[axis])
        };
        let near = mesh.face_ids().filter(is_near).collect();
        Self { vertices, edge_m, star: star.into_iter().collect(), near }
    }

    fn best_step(&self, relaxer: &Relaxer<'_>) -> Option<Step> {
        let Relaxer { mesh, frame, rest, settings, .. } = relaxer;
        let before = self.pairs(mesh, frame, usize::MAX);
        let directions = directions(mesh, frame, &before);
        let mut moved = frame.clone();
        let mut best: Option<Step> = None;
        for length in LENGTHS {
            if (relaxer.should_stop)() {
                return None;
            }
            for direction in &directions {
                let most = before.len() - best.map_or(0, |best| best.gain);
                let displacement = direction * (length * self.edge_m);
                let mut put = |vertex: VertexId| {
                    let place = stored(frame.position(vertex) + displacement, settings.single_precision);
                    moved.put(vertex, place).is_some()
                };
                if !self.vertices.into_iter().all(&mut put) {
                    continue;
                }
                let (from, to) = (frame.positions(), moved.positions());
                let is_violated = |&vertex: &VertexId| LIMITS.are_violated(mesh, rest, from, to, vertex);
                if self.vertices.iter().any(is_violated) {
                    continue;
                }
                let num_after = self.pairs(mesh, &moved, most).len();
                if num_after < most {
                    best = Some(Step { vertices: self.vertices, displacement, gain: before.len() - num_after, length });
                }
            }
            if best.is_some_and(|best| best.gain == before.len()) {
                break;
            }
        }
        best
    }

    /// The pairs of faces that intersect, no more than `most`, of which one is a face of the vertices, which stands
    /// first.
    fn pairs(&self, mesh: &Mesh, frame: &Frame, most: usize) -> Vec<[FaceId; 2]> {
        let mut pairs = Vec::new();
        for &own in &self.star {
            let corners = mesh.face(own).map(|corner| frame.position(corner));
            let (low, high) = extent(corners);
            for &other in &self.near {
                let (other_low, other_high) = extent(mesh.face(other).map(|corner| frame.position(corner)));
                let overlaps = (0..3).all(|axis| other_low[axis] <= high[axis] && low[axis] <= other_high[axis]);
                let is_second = other <= own && self.star.binary_search(&other).is_ok();
                if overlaps && !is_second && do_intersect(mesh, frame, [own, other]) {
                    pairs.push([own, other]);
                    if pairs.len() >= most {
                        return pairs;
                    }
                }
            }
        }
        pairs
    }
}

/// Directions in which vertices may leave what its faces intersect: across both faces of a pair, along their line, and
/// between these.
fn directions(mesh: &Mesh, frame: &Frame, pairs: &[[FaceId; 2]]) -> Vec<Vector3<f64>> {
    let normal = |face: FaceId| {
        let [a, b, c] = mesh.face(face).map(|corner| frame.position(corner));
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    let mut directions = Vec::new();
    for &[own, other] in pairs.iter().take(MAX_PAIRS) {
        let (Some(own), Some(other)) = (normal(own), normal(other)) else { continue };
        let along = own.cross(&other).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        for weights in 0..27 {
            let [a, b, c] = [weights % 3, weights / 3 % 3, weights / 9].map(|weight| f64::from(weight) - 1.0);
            directions.extend((other * a + own * b + along * c).try_normalize(1e-6));
        }
    }
    directions
}

/// The box round some points.
fn extent(points: impl IntoIterator<Item = Point3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    points.into_iter().fold(empty, |(low, high), at| (low.inf(&at.coords), high.sup(&at.coords)))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{mesh::MeshDescription, relax::settings::RelaxSettings};

    /// Of the hem above the sheet, and of its middle below it.
    const DEPTH_M: f64 = 0.02;

    /// A sheet of `size` x `size` squares whose hem is folded back over it, but for the middle of the hem, which has
    /// gone through.
    fn hem(size: u32) -> (Mesh, Vec<[f64; 3]>) {
        let row = size + 1;
        let edge = 1.0 / f64::from(size);
        let mut positions = Vec::new();
        for step in 0..=size {
            for column in 0..=size {
                // The last row is the hem, not far from the row two before it.
                let is_hem = step == size;
                let y = f64::from(step) * edge - if is_hem { 1.6 * edge } else { 0.0 };
                positions.push([f64::from(column) * edge, y, if is_hem { DEPTH_M } else { 0.0 }]);
            }
        }
        let middle = size * row + size / 2;
        positions[middle as usize][2] = -DEPTH_M;
        let corner = |index: u32| index / size * row + index % size;
        let two = |a: u32| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]];
        let faces = (0..size * size).flat_map(|index| two(corner(index))).collect();
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
        (mesh, positions)
    }

    #[test]
    fn nudge_of_a_hem_that_goes_through_its_sheet_by_a_vertex_moves_two_vertices_at_most_at_any_resolution() {
        for size in [8, 16, 32] {
            clears(size);
        }
    }

    fn clears(size: u32) {
        let (mesh, positions) = hem(size);
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
        let start = relaxer.frame.positions().to_vec();
        relaxer.set_frame(&start).unwrap();
        relaxer.measure_islands(0);
        let merit = total(&relaxer.now).merit();
        assert!(merit > 0.0);
        let mut best = BestState { merit, positions: start.clone() };
        let end = nudge(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(end, End::Clean);
        let moved: Vec<usize> = (0..start.len()).filter(|&index| start[index] != best.positions[index]).collect();
        assert!((1..=2).contains(&moved.len()), "{moved:?}");
        stays_where_all_is_pinned(&mesh, &start, merit);
    }

    fn stays_where_all_is_pinned(mesh: &Mesh, positions: &[Point3<f64>], merit: f64) {
        let pins = (0..positions.len()).filter_map(|index| u32::try_from(index).ok()).collect();
        let faces = mesh.face_ids().map(|face| mesh.face(face).map(|corner| corner.0)).collect();
        let held = MeshDescription { num_vertices: positions.len(), faces, pins, ..Default::default() };
        let held = Mesh::new(held).unwrap();
        let start: Vec<[f64; 3]> = positions.iter().map(|at| (*at).into()).collect();
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(&held, &start, &settings, &|| false).unwrap();
        let mut best = BestState { merit, positions: positions.to_vec() };
        nudge(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(best.positions, positions);
    }
}
