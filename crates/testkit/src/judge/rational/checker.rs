//! The answers of the judge of files, held against those in fractions. It knows no move of vertices: what touches is
//! told apart from what crosses.

use std::{cmp::Ordering, collections::BTreeSet};

use untangled_checker::{crossings, edge_face_hits, near_pairs};

use super::{
    gap::{edges_squared, vertex_squared},
    library::{Compared, is_nearer, root},
    number::{Fraction, Point, dot, minus},
    surface::{Edge, Surface},
};

/// Compares which edges and faces have a common point, and how many primitives are nearer than some distances; and what
/// crosses for good has to intersect after any small move.
///
/// # Errors
/// What differs, in words.
pub(super) fn compare_checker(faces: &[[u32; 3]], positions: &[[f64; 3]]) -> Result<Compared, String> {
    let mut compared = Compared::default();
    let Some(judge) = Surface::new(positions, faces, &[]) else { return Ok(compared) };
    // As they count, which the judge of files leaves to others.
    let positions: Vec<[f64; 3]> =
        judge.points().iter().map(|point| point.each_ref().map(|value| value.to_f64().value())).collect();
    let usable: Vec<[u32; 3]> = judge.faces().map(|(_, corners)| corners).collect();
    let hits = edge_face_hits(&positions, &usable).map_err(|error| error.to_string())?;
    let found: BTreeSet<(Edge, [u32; 3])> = hits.iter().map(|hit| (hit.edge, usable[hit.triangle as usize])).collect();
    let mut expected = BTreeSet::new();
    for edge in judge.edges() {
        for &corners in usable.iter().filter(|corners| edge.iter().all(|end| !corners.contains(end))) {
            compared.num_pairs += 1;
            if meets(judge.points(), edge, corners) {
                expected.insert((edge, corners));
            }
        }
    }
    if found != expected {
        return Err(format!("edges and faces with a common point: {found:?}, expected {expected:?}"));
    }
    compared.num_positive += expected.len();
    compared.num_decisions += compare_near(&judge, &positions, &usable)?;
    let crossing = crossings(&positions, &usable).map_err(|error| error.to_string())?.pairs;
    if !crossing.is_empty() && judge.intersections().faces.is_empty() {
        return Err(format!("triangles {crossing:?} cross for good, but not after the move"));
    }
    Ok(compared)
}

/// How many primitives are nearer than some of their distances.
fn compare_near(judge: &Surface, positions: &[[f64; 3]], usable: &[[u32; 3]]) -> Result<usize, String> {
    let at = |vertex: u32| &judge.points()[vertex as usize];
    let used: BTreeSet<u32> = usable.iter().flatten().copied().collect();
    let mut vertices = Vec::new();
    for corners in usable {
        let others = used.iter().filter(|vertex| !corners.contains(vertex));
        vertices.extend(others.map(|&vertex| vertex_squared(at(vertex), corners.map(at))));
    }
    let all: Vec<Edge> = judge.edges().into_iter().collect();
    let mut edges = Vec::new();
    for (number, first) in all.iter().enumerate() {
        let others = all[number + 1..].iter().filter(|second| !first.iter().any(|end| second.contains(end)));
        edges.extend(others.map(|second| edges_squared(first.map(at), second.map(at))));
    }
    let mut sorted: Vec<&Fraction> = vertices.iter().chain(&edges).collect();
    sorted.sort_unstable();
    let mut num_decisions = 0;
    for part in [sorted.len() / 8, sorted.len() / 3, sorted.len() / 2] {
        let Some(distance) = sorted.get(part).map(|squared| root(squared)).filter(|distance| *distance > 0.0) else {
            continue;
        };
        for distance in [distance, distance.next_up()] {
            let found = near_pairs(positions, usable, usable.len(), distance).map_err(|error| error.to_string())?;
            let count = |all: &[Fraction]| all.iter().filter(|squared| is_nearer(squared, distance)).count();
            let expected = [count(&vertices), count(&edges)];
            if [found.num_vertex_triangle, found.num_edge_edge] != expected {
                return Err(format!("pairs nearer than {distance:e}: {found:?}, expected {expected:?}"));
            }
            num_decisions += sorted.len();
        }
    }
    Ok(num_decisions)
}

/// Whether an edge and a triangle have a common point, both with their borders: an end in the triangle, two edges that
/// meet, or the edge through the inside.
fn meets(points: &[Point], [p, q]: Edge, [a, b, c]: [u32; 3]) -> bool {
    let at = |vertex: u32| &points[vertex as usize];
    let touches = [p, q].iter().any(|&end| vertex_squared(at(end), [a, b, c].map(at)) == Fraction::ZERO)
        || [[a, b], [b, c], [c, a]].iter().any(|side| edges_squared([p, q].map(at), side.map(at)) == Fraction::ZERO);
    let sign = |[a, b, c, d]: [u32; 4]| volume([a, b, c, d].map(at)).cmp(&Fraction::ZERO);
    let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| sign([p, q, from, to]));
    touches
        || (sign([a, b, c, p]) == sign([a, b, c, q]).reverse()
            && turns[0] != Ordering::Equal
            && turns.iter().all(|turn| *turn == turns[0]))
}

/// Six times the volume of four points as they are.
fn volume([a, b, c, d]: [&Point; 4]) -> Fraction {
    let (u, v) = (minus(b, a), minus(c, a));
    let cross: Point = [(1, 2), (2, 0), (0, 1)].map(|(j, k)| &u[j] * &v[k] - &u[k] * &v[j]);
    dot(&cross, &minus(d, a))
}
