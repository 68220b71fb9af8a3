//! What is left of a tangle where a displacement of whole sheets does not help: single vertices step to the other side
//! of what they pierce, or two neighbours together. A hem that folded over by a vertex is such a place: its faces have
//! vertices in common, and can't be shifted against each other.
//!
//! | file | purpose |
//! |---|---|
//! | `face_tree` | faces near a place |
//! | `surroundings` | what the faces of a vertex intersect, and the step out of that |
//!
//! A row uses those above it only.

mod face_tree;
mod surroundings;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::{
    outcome::{BestState, End, Method, RelaxError},
    relaxer::{Progress, Relaxer},
    step::{num_movable, stored, total},
};
use crate::{frame::Frame, intersect::Intersections, mesh::VertexId};
use face_tree::FaceTree;
use surroundings::{Step, Surroundings};

/// More edge-face intersections than this are for whole sheets.
const FEW: usize = 32;
/// Most vertices that step.
const MAX_STEPS: usize = 32;

/// Steps single vertices from the best state, as long as that leaves it less tangled and within limits of strain.
///
/// Cost: for each step an analysis, a tree of all faces, and for each vertex of what intersects, in parallel, some
/// thousand tests of its faces with those near them.
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
        if (relaxer.should_stop)() {
            // What was cut short is not taken.
            return Ok(End::Interrupted);
        }
        relaxer.measure_islands(0);
        let merit = total(&relaxer.now).merit();
        if merit < best.merit {
            *best = BestState { merit, positions };
            if relaxer.report(Method::Nudge, progress).is_break() {
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
    let tree = FaceTree::of(mesh, &relaxer.frame);
    let steps: Vec<Option<Step>> = vertices
        .par_iter()
        .map_init(|| relaxer.frame.clone(), |moved, &vertex| best_of_vertex(relaxer, &tree, vertex, moved))
        .collect();
    steps.into_iter().flatten().min_by(|a, b| b.gain.cmp(&a.gain).then(a.length_m.total_cmp(&b.length_m)))
}

/// The step of a vertex that helps most; with a neighbour only where alone it does not resolve all that it meets.
fn best_of_vertex(relaxer: &Relaxer<'_>, tree: &FaceTree, vertex: VertexId, moved: &mut Frame) -> Option<Step> {
    let mesh = relaxer.mesh;
    let alone = Surroundings::of(relaxer, tree, [vertex; 2]);
    let num_pairs = alone.num_pairs(relaxer);
    let mut best = alone.best_step(relaxer, moved);
    let neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
    for other in neighbours.filter(|other| !mesh.is_pinned(*other)) {
        if best.is_some_and(|best| best.gain >= num_pairs) {
            break;
        }
        let step = Surroundings::of(relaxer, tree, [vertex, other]).best_step(relaxer, moved);
        if step.map_or(0, |step| step.gain) > best.map_or(0, |best| best.gain) {
            best = step;
        }
    }
    best
}
