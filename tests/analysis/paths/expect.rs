//! What is expected of the one tangle of a sheet.

use untangle::{
    analysis::Analysis,
    mesh::{Mesh, VertexId},
    paths::{PairType, PathType},
};
use untangled_testkit::{generate::Sheet, judge::rules};

/// The analysis of a sheet, after the rules that every analysis obeys.
pub(super) fn analyse(sheet: &Sheet) -> (Mesh, Analysis) {
    let (mesh, frame, analysis) = sheet.analyse();
    rules::check_paths(&mesh, &frame, &analysis, 10.0);
    (mesh, analysis)
}

/// Asserts the types of all pairs, and returns mesh and analysis for more.
#[track_caller]
pub(super) fn assert_types(sheet: &Sheet, pairs: &[PairType], copies: &[PathType]) -> (Mesh, Analysis) {
    let (mesh, analysis) = analyse(sheet);
    let mut found: Vec<_> = analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect();
    found.sort();
    assert_eq!(found, pairs);
    let mut found: Vec<_> = analysis.paths.copies.iter().map(|copy| copy.path_type).collect();
    found.sort();
    assert_eq!(found, copies);
    (mesh, analysis)
}

/// Asserts that the regions of all copies together are the vertices for which `inside` holds, where it is the same for
/// all neighbours: next to the path the mesh decides, not the formula.
#[track_caller]
pub(super) fn assert_inside(sheet: &Sheet, (mesh, analysis): &(Mesh, Analysis), inside: impl Fn(VertexId) -> bool) {
    assert_inside_where(sheet, (mesh, analysis), inside, |_| true);
}

/// As [`assert_inside`]; but both must agree only where `decided` holds for a vertex and its neighbours.
#[track_caller]
fn assert_inside_where(
    sheet: &Sheet,
    (mesh, analysis): (&Mesh, &Analysis),
    inside: impl Fn(VertexId) -> bool,
    decided: impl Fn(VertexId) -> bool,
) {
    let mut found: Vec<VertexId> = analysis.regions.vertices.clone();
    found.sort();
    found.dedup();
    assert!(!found.is_empty());
    let mut num_checked = 0;
    for vertex in mesh.vertex_ids() {
        let expected = inside(vertex);
        let mut neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
        let agrees = |other: VertexId| inside(other) == expected && decided(other);
        if agrees(vertex) && neighbours.all(agrees) {
            let [u, v] = sheet.uvs[vertex.index()];
            assert_eq!(found.binary_search(&vertex).is_ok(), expected, "vertex {} at ({u}, {v})", vertex.0);
            num_checked += usize::from(expected);
        }
    }
    assert!(num_checked > 0, "the scene has no vertex well inside");
}

/// Asserts that the region of a folded path is the smaller part of the disc round its loop vertex, of this radius: that
/// where `side` holds.
#[track_caller]
pub(super) fn assert_disc(
    sheet: &Sheet,
    (mesh, analysis): &(Mesh, Analysis),
    [cu, cv]: [f64; 2],
    radius: f64,
    side: impl Fn([f64; 2]) -> bool,
) {
    let distance = |vertex: VertexId| {
        let [u, v] = sheet.uvs[vertex.index()];
        (u - cu).hypot(v - cv)
    };
    // The scene's radius is known up to the width of a face.
    let clear = |vertex: VertexId| (distance(vertex) - radius).abs() > 0.03;
    let inside = |vertex: VertexId| distance(vertex) < radius && side(sheet.uvs[vertex.index()]);
    assert_inside_where(sheet, (mesh, analysis), inside, clear);
}
