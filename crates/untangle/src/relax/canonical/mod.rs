//! The solver on a form of the input that hangs on its shape alone: which of several motions is taken, where they are
//! about as good, must hang neither on the last bits of positions nor on the names of vertices.
//!
//! Places are rounded to a grid, far finer than any edge, and vertices and faces are named in the order of their
//! places; vertices in one place keep their order. What the solver moves there is added to the input. Where rounding
//! makes something intersect away from what does, or the result, the input is solved as it is. Beside it rounding may:
//! where an end of a path touches something exactly, which edges pierce which faces hangs on the last bits.

mod renamed;

use nalgebra::{Point3, Vector3};

use super::{
    outcome::{RelaxError, Relaxation, Solution, blocked_paths},
    relaxer::Progress,
    settings::{RelaxSettings, ShouldStop},
    solver::solve,
    step::stored,
};
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{IntersectionPaths, PathFinder},
};
use renamed::renamed;

/// The distance of places, as a part of the power of two that is next below the diagonal.
const CELL: f64 = 1.0 / 262_144.0;

/// See [`relax`](super::relax).
///
/// Cost: that of the solver, another mesh, and four searches for intersections.
pub(super) fn run(
    mesh: &Mesh,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    progress: &mut Progress<'_>,
    should_stop: &ShouldStop<'_>,
) -> Result<Relaxation, RelaxError> {
    let input = Frame::new(mesh, positions)?;
    let mut solution = None;
    // Frames that follow each other are to move alike, and places of one round otherwise than those of the next.
    if settings.other_attempts
        && !should_stop()
        && let Some(form) = CanonicalForm::of(mesh, &input)
    {
        let found = solve(&form.mesh, &form.positions, settings, progress, should_stop)?;
        solution = form.added_to(mesh, &input, found, settings.single_precision)?;
    }
    let solution = match solution {
        Some(solution) => solution,
        None => solve(mesh, positions, settings, progress, should_stop)?,
    };
    relaxation(mesh, &input, positions, solution)
}

/// What a solution is for the caller.
fn relaxation(mesh: &Mesh, input: &Frame, given: &[[f64; 3]], solution: Solution) -> Result<Relaxation, RelaxError> {
    let restored = |(point, (before, given)): (&Point3<f64>, (&Point3<f64>, &[f64; 3]))| {
        // A frame takes the smallest values as zero.
        if point == before { *given } else { (*point).into() }
    };
    let pairs = solution.positions.iter().zip(input.positions().iter().zip(given));
    let positions: Vec<[f64; 3]> = pairs.map(restored).collect();
    let frame = Frame::new(mesh, &positions)?;
    let (mut found, mut paths) = (Intersections::default(), IntersectionPaths::default());
    Intersector::default().intersect(mesh, &frame, &mut found);
    PathFinder::default().find(mesh, &frame, &found, &mut paths);
    let Solution { history, end, is_crowded, interrupted, .. } = solution;
    Ok(Relaxation { positions, history, blocked: blocked_paths(mesh, &paths, end, is_crowded), interrupted })
}

/// A mesh under other names, in places of a grid.
struct CanonicalForm {
    mesh: Mesh,
    positions: Vec<[f64; 3]>,
    /// For each of its vertices that of the input.
    order: Vec<VertexId>,
}

impl CanonicalForm {
    /// Nothing where nothing intersects, or something does or does no more in the places of the grid that is away from
    /// the rest, and where bodies or layers say who belongs where: what is on the wrong side hangs on places too.
    fn of(mesh: &Mesh, input: &Frame) -> Option<Self> {
        if mesh.has_body() || mesh.layers().is_some() {
            return None;
        }
        let before = pierced(mesh, input);
        if before.is_empty() {
            return None;
        }
        let cell_m = cell_m(mesh, input)?;
        // No zero is negative.
        let rounded =
            |point: &Point3<f64>| <[f64; 3]>::from(point.map(|value| (value / cell_m).round() * cell_m + 0.0));
        let places: Vec<[f64; 3]> = input.positions().iter().map(rounded).collect();
        let frame = Frame::new(mesh, &places).ok()?;
        let there = pierced(mesh, &frame);
        if !are_beside(mesh, &there, &before) || !are_beside(mesh, &before, &there) {
            return None;
        }
        let mut order: Vec<VertexId> = mesh.vertex_ids().collect();
        let place = |vertex: &VertexId| places[vertex.index()];
        let compare = |a: f64, b: f64| a.total_cmp(&b);
        order.sort_by(|a, b| {
            let [a, b] = [place(a), place(b)];
            compare(a[0], b[0]).then(compare(a[1], b[1])).then(compare(a[2], b[2]))
        });
        let positions = order.iter().map(place).collect();
        let mesh = Mesh::new(renamed(mesh, &order)).ok()?;
        Some(Self { mesh, positions, order })
    }

    /// The input with what moved in a solution. Nothing where something intersects after that, and not the same as in
    /// the solution.
    fn added_to(
        &self,
        mesh: &Mesh,
        input: &Frame,
        mut solution: Solution,
        single_precision: bool,
    ) -> Result<Option<Solution>, RelaxError> {
        let mut there = vec![Point3::origin(); self.order.len()];
        let mut here = input.positions().to_vec();
        for (vertex, (after, before)) in self.order.iter().zip(solution.positions.iter().zip(&self.positions)) {
            let displacement: Vector3<f64> = after - Point3::from(*before);
            there[vertex.index()] = *after;
            if displacement != Vector3::zeros() {
                here[vertex.index()] = stored(here[vertex.index()] + displacement, single_precision);
            }
        }
        let frame = |positions: &[Point3<f64>]| {
            let positions: Vec<[f64; 3]> = positions.iter().map(|&point| point.into()).collect();
            Frame::new(mesh, &positions)
        };
        let pierced_here = pierced(mesh, &frame(&here)?);
        let is_same = pierced_here.is_empty() || pierced_here == pierced(mesh, &frame(&there)?);
        solution.positions = here;
        // Where the caller ends the work, there is no time for another solution.
        Ok((is_same || solution.interrupted).then_some(solution))
    }
}

/// The distance of places for a mesh, that of its free part; nothing where that has no size.
fn cell_m(mesh: &Mesh, frame: &Frame) -> Option<f64> {
    let free = mesh.vertex_ids().filter(|vertex| !mesh.is_pinned(*vertex) && !mesh.vertex_faces(*vertex).is_empty());
    let empty = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = free.fold(empty, |(low, high), vertex| {
        let at = frame.position(vertex).coords;
        (low.inf(&at), high.sup(&at))
    });
    let diagonal = (high - low).norm();
    let power = f64::from_bits(diagonal.to_bits() & f64::INFINITY.to_bits());
    (diagonal.is_finite() && power > 0.0).then_some(CELL * power)
}

/// The edges that pierce a face, with it, in order.
fn pierced(mesh: &Mesh, frame: &Frame) -> Vec<(EdgeId, FaceId)> {
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, frame, &mut found);
    let mut pairs: Vec<(EdgeId, FaceId)> = found.edge_face.iter().map(|found| (found.edge, found.face)).collect();
    pairs.sort_unstable();
    pairs
}

/// Whether each pair of an edge and a face has a vertex in common with one of the others.
fn are_beside(mesh: &Mesh, pairs: &[(EdgeId, FaceId)], others: &[(EdgeId, FaceId)]) -> bool {
    let vertices = |&(edge, face): &(EdgeId, FaceId)| mesh.edge(edge).into_iter().chain(mesh.face(face));
    let mut is_marked = vec![false; mesh.num_vertices()];
    others.iter().flat_map(vertices).for_each(|vertex| is_marked[vertex.index()] = true);
    pairs.iter().all(|pair| vertices(pair).any(|vertex| is_marked[vertex.index()]))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{
        mesh::MeshDescription,
        relax::{escape::tests::samples::Pieces, outcome::End, relax},
    };

    /// How vertices move that are given in another order, each moved by up to a distance before.
    fn displacements(pieces: &Pieces, order: &[u32], moved_m: f64) -> Vec<Vector3<f64>> {
        let (mesh, _) = pieces.mesh();
        let old: Vec<VertexId> = order.iter().map(|&vertex| VertexId(vertex)).collect();
        let mesh = Mesh::new(renamed(&mesh, &old)).unwrap();
        let noise = |vertex: u32, k: usize| moved_m * (f64::from(vertex) * 1.7 + [0.0, 2.0, 4.0][k]).sin();
        let place = |&vertex: &u32| {
            let at = pieces.positions[vertex as usize];
            [0, 1, 2].map(|k| at[k] + noise(vertex, k))
        };
        let input: Vec<[f64; 3]> = order.iter().map(place).collect();
        let found = relax(&mesh, &input, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(found.blocked.is_empty());
        let mut displacements = vec![Vector3::zeros(); order.len()];
        for (&vertex, (after, before)) in order.iter().zip(found.positions.iter().zip(&input)) {
            displacements[vertex as usize] = Point3::from(*after) - Point3::from(*before);
        }
        displacements
    }

    #[test]
    fn shape_under_other_names_or_a_little_moved_moves_alike() {
        for pieces in [Pieces::finger(12), Pieces::tongue(8, 0.35)] {
            let num_vertices = u32::try_from(pieces.positions.len()).unwrap();
            let order: Vec<u32> = (0..num_vertices).collect();
            let expected = displacements(&pieces, &order, 0.0);
            let others = [order.iter().rev().copied().collect::<Vec<u32>>(), order];
            for (order, moved_m) in others.iter().flat_map(|order| [(order, 0.0), (order, 1e-12)]) {
                let found = displacements(&pieces, order, moved_m);
                let farthest = found.iter().zip(&expected).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
                println!("{farthest:e}");
                assert!(farthest < 1e-14);
            }
        }
    }

    /// Cells in a metre, for the two triangles.
    const CELLS: f64 = 131_072.0;

    /// A triangle, and another one whose lowest corner is at such a height, in cells; where it is the first one is 0.54
    /// high, and 0.71 after its corners are rounded.
    fn two_triangles(height_cells: f64) -> (Mesh, Frame) {
        let faces = vec![[0, 1, 2], [3, 4, 5]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
        let [a, b, low] = [0.6, 0.4, height_cells].map(|cells| cells / CELLS);
        let positions = [[0., 0., a], [2., 0., b], [0., 1.5, b], [0.25, 0.25, low], [0.25, 0.5, 1.], [0.5, 0.25, 1.]];
        let frame = Frame::new(&mesh, &positions).unwrap();
        (mesh, frame)
    }

    #[test]
    fn rounding_that_changes_what_intersects_is_not_used() {
        for (height_cells, is_used) in [(-0.75, true), (0.52, false), (1.75, false)] {
            let (mesh, frame) = two_triangles(height_cells);
            assert_eq!(CanonicalForm::of(&mesh, &frame).is_some(), is_used, "{height_cells}");
        }
    }

    #[test]
    fn rounding_that_changes_what_intersects_beside_the_rest_is_used() {
        // Two triangles that hang down from a common edge, by one corner each; rounding lifts the second one out.
        let level = [0.6, 0.4, 0.4].map(|cells| cells / CELLS);
        let [first, second] = [-0.75, 0.52].map(|cells| cells / CELLS);
        let positions = [
            [0., 0., level[0]],
            [2., 0., level[1]],
            [0., 1.5, level[2]],
            [0.25, 0.25, first],
            [0.5, 0.25, 1.],
            [0.25, 0.5, 1.],
            [0.25, 0.25, second],
        ];
        let form = |faces: &[[u32; 3]]| {
            let description = MeshDescription { num_vertices: 7, faces: faces.to_vec(), ..Default::default() };
            let mesh = Mesh::new(description).unwrap();
            CanonicalForm::of(&mesh, &Frame::new(&mesh, &positions).unwrap()).is_some()
        };
        assert!(form(&[[0, 1, 2], [3, 4, 5], [6, 5, 4]]));
        assert!(!form(&[[0, 1, 2], [6, 5, 4]]));
    }

    #[test]
    fn solution_that_the_places_of_the_input_undo_is_not_used() {
        // The corner is rounded up by a quarter of a cell, or down.
        for (height_cells, is_clean) in [(-1.25, false), (-0.75, true)] {
            let (mesh, frame) = two_triangles(height_cells);
            let form = CanonicalForm::of(&mesh, &frame).unwrap();
            // Where it is rounded to -1, it ends a little above the first triangle.
            let lifted = |(old, place): (&VertexId, &[f64; 3])| {
                let cells = if old.0 < 3 { 0.0 } else { 1.75 };
                Point3::from(*place) + Vector3::z() * (cells / CELLS)
            };
            let positions = form.order.iter().zip(&form.positions).map(lifted).collect();
            let solution =
                Solution { positions, history: Vec::new(), end: End::Clean, is_crowded: false, interrupted: false };
            let found = form.added_to(&mesh, &frame, solution, false).unwrap();
            assert_eq!(found.is_some(), is_clean, "{height_cells}");
        }
    }
}
