//! One generated scene for each type of intersection path, with the answer that the definitions give.
//!
//! Folded sheets: `f(u, v) = (u^2, v, a tanh(u / e) g(u^2, v))`. The layers `u` and `-u` meet exactly where `g = 0`, and the sheet meets
//! itself in one point, a loop vertex, where that curve reaches the crease `u = 0`. So the paths in the parameter domain are known
//! beforehand, and with them their types and inside regions. The other scenes are flat sheets placed through each other.

#![allow(clippy::unwrap_used, reason = "a test")]

mod support;

use support::{
    rules,
    scene::{Scene, folded},
};
use untangle::{analysis::Analysis, mesh::{Mesh, VertexId}, paths::{PairType, PathPoint, PathType, SurfacePoint}};

/// The analysis of a scene, after the rules that every analysis obeys.
fn analyse(scene: &Scene) -> (Mesh, Analysis) {
    let (mesh, frame, analysis) = scene.analyse();
    rules::check_paths(&mesh, &frame, &analysis, 10.0);
    (mesh, analysis)
}

/// Asserts the types of all pairs, and returns mesh and analysis for more.
#[track_caller]
fn assert_types(scene: &Scene, pairs: &[PairType], copies: &[PathType]) -> (Mesh, Analysis) {
    let (mesh, analysis) = analyse(scene);
    let mut found: Vec<_> = analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect();
    found.sort();
    assert_eq!(found, pairs);
    let mut found: Vec<_> = analysis.paths.copies.iter().map(|copy| copy.path_type).collect();
    found.sort();
    assert_eq!(found, copies);
    (mesh, analysis)
}

/// Asserts that the regions of all copies together are the vertices for which `inside` holds, where it is the same for all neighbours: next
/// to the path the mesh decides, not the formula.
#[track_caller]
fn assert_inside(scene: &Scene, (mesh, analysis): &(Mesh, Analysis), inside: impl Fn(VertexId) -> bool) {
    assert_inside_where(scene, (mesh, analysis), inside, |_| true);
}

/// As [`assert_inside`]; but both must agree only where `decided` holds for a vertex and its neighbours.
#[track_caller]
fn assert_inside_where(
    scene: &Scene,
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
            let [u, v] = scene.uvs[vertex.index()];
            assert_eq!(found.binary_search(&vertex).is_ok(), expected, "vertex {} at ({u}, {v})", vertex.0);
            num_checked += usize::from(expected);
        }
    }
    assert!(num_checked > 0, "the scene has no vertex well inside");
}

/// Asserts that the region of a folded path is the smaller part of the disc round its loop vertex, of this radius: that where `side` holds.
#[track_caller]
fn assert_disc(
    scene: &Scene,
    (mesh, analysis): &(Mesh, Analysis),
    [cu, cv]: [f64; 2],
    radius: f64,
    side: impl Fn([f64; 2]) -> bool,
) {
    let distance = |vertex: VertexId| {
        let [u, v] = scene.uvs[vertex.index()];
        (u - cu).hypot(v - cv)
    };
    // The scene's radius is known up to the width of a face.
    let clear = |vertex: VertexId| (distance(vertex) - radius).abs() > 0.03;
    let inside = |vertex: VertexId| distance(vertex) < radius && side(scene.uvs[vertex.index()]);
    assert_inside_where(scene, (mesh, analysis), inside, clear);
}

#[test]
fn a_bump_through_a_sheet_is_closed() {
    let mut scene = Scene::default();
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [23, 21], |x, y| [x, y, 0.01 * x]);
    let height = |x: f64, y: f64| 0.5 - 2.0 * (x * x + y * y);
    scene.add_grid([-0.9, 0.93], [-0.91, 0.9], [22, 24], |x, y| [x, y, height(x, y)]);
    let found = assert_types(&scene, &[PairType::Closed], &[PathType::Closed; 2]);
    assert_inside(&scene, &found, |vertex| {
        let [x, y] = scene.uvs[vertex.index()];
        height(x, y) > 0.01 * x
    });
}

#[test]
fn a_closed_curve_over_the_crease_is_a_loop_loop() {
    let g = |x: f64, v: f64| (x / 0.5).powi(2) + ((v - 0.5) / 0.3).powi(2) - 1.0;
    let scene = Scene::fold([-1.0, 0.97], [40, 31], g);
    let found = assert_types(&scene, &[PairType::LoopLoop], &[PathType::LoopLoop]);
    assert_eq!(found.1.paths.pairs[0].loop_vertices.len(), 2);
    assert_inside(&scene, &found, |vertex| {
        let [u, v] = scene.uvs[vertex.index()];
        g(u * u, v) < 0.0
    });
}

#[test]
fn a_curve_from_the_boundary_over_the_crease_is_a_boundary_loop_inside() {
    // The sheet is shorter on one side of the crease: there the curve reaches the boundary, on the other side it ends inside.
    let scene = Scene::fold([-1.0, 0.8], [40, 31], |x, v| v - 0.4 - 0.2 * x);
    let found = assert_types(&scene, &[PairType::BoundaryLoopInside], &[PathType::BoundaryLoopInside]);
    let region = found.1.regions.by_copy[0].as_ref().unwrap();
    assert!(region.partitioning);
    // Both ends lie on u = 0.8 and u = -0.8, 0.2 * 0.64 higher than the loop vertex.
    let expected = 0.8f64.hypot(0.2 * 0.64);
    let radius = region.disc_radius.unwrap();
    assert!((radius - expected).abs() < 0.05, "radius {radius}");
    assert_eq!(found.1.paths.pairs[0].loop_vertices.len(), 1);
    // Which part of the disc is smaller is counted, since the sheet's edges cut it off.
    let above = |[u, v]: [f64; 2]| v > 0.4 + 0.2 * u * u;
    let count = |side: bool| {
        let is_there = |&&[u, v]: &&[f64; 2]| u.hypot(v - 0.4) < expected && above([u, v]) == side;
        scene.uvs.iter().filter(is_there).count()
    };
    let smaller = count(true) < count(false);
    assert_disc(&scene, &found, [0.0, 0.4], expected, |uv| above(uv) == smaller);
}

/// The sheet is as long on both sides of the crease: both copies end in the boundary, where its two ends touch exactly. The
/// columns between differ, so that nothing else does.
#[test]
fn a_curve_over_the_crease_that_ends_where_boundaries_touch_is_a_boundary_loop_boundary() {
    let us: Vec<f64> =
        (-19..=0).map(|i| f64::from(i) * 0.75 / 19.0).chain((1..=17).map(|i| f64::from(i) * 0.75 / 17.0)).collect();
    let vs: Vec<f64> = (0..=31).map(|j| f64::from(j) / 31.0).collect();
    let mut scene = Scene::default();
    scene.add_lines(&us, &vs, folded(|x, v| v - 0.4 - 0.2 * x));
    let found = assert_types(&scene, &[PairType::BoundaryLoopBoundary], &[PathType::BoundaryLoopBoundary]);
    let region = found.1.regions.by_copy[0].as_ref().unwrap();
    assert!(region.partitioning);
    let (points, paths) = (&found.1.paths.copies[0].points, &found.1.paths);
    for end in [points.start, points.end - 1] {
        let on_boundary = match paths.points[end].own {
            SurfacePoint::Edge { edge, .. } => found.0.is_boundary_edge(edge),
            SurfacePoint::Vertex(vertex) => found.0.is_boundary_vertex(vertex),
            SurfacePoint::Face { .. } => false,
        };
        assert!(on_boundary, "{:?}", paths.points[end].own);
    }
    // On the boundary the curve is where the formula says; the loop vertex is the nearest one on the crease.
    let [cu, cv] = scene.uvs[paths.pairs[0].loop_vertices[0].index()];
    let expected = 0.75f64.hypot(0.4 + 0.2 * 0.75 * 0.75 - cv);
    assert!((region.disc_radius.unwrap() - expected).abs() < 1e-9 && cu.abs() <= 0.0);
    let above = |[u, v]: [f64; 2]| v > 0.4 + 0.2 * u * u;
    let count = |side: bool| {
        let is_there = |&&[u, v]: &&[f64; 2]| u.hypot(v - cv) < expected && above([u, v]) == side;
        scene.uvs.iter().filter(is_there).count()
    };
    let smaller = count(true) < count(false);
    assert_disc(&scene, &found, [cu, cv], expected, |uv| above(uv) == smaller);
}

#[test]
fn a_drop_that_touches_the_crease_is_an_eight() {
    // A vertex stands in the tip of the drop.
    let g = |x: f64, v: f64| (v - 0.5).powi(2) - x * x * (0.6 - x);
    let scene = Scene::fold([-1.0, 1.0], [36, 36], g);
    let found = assert_types(&scene, &[PairType::Eight], &[PathType::Closed; 2]);
    assert_inside(&scene, &found, |vertex| {
        let [u, v] = scene.uvs[vertex.index()];
        g(u * u, v) < 0.0
    });
}

#[test]
fn a_wedge_that_starts_at_the_crease_is_a_cross() {
    let g = |x: f64, v: f64| (v - 0.5).powi(2) - 0.09 * x * x;
    let scene = Scene::fold([-1.0, 0.9], [38, 36], g);
    let found = assert_types(&scene, &[PairType::Cross], &[PathType::BoundaryBoundary, PathType::InsideInside]);
    // On the short side both curves reach the boundary: the wedge there is inside.
    assert_inside(&scene, &found, |vertex| {
        let [u, v] = scene.uvs[vertex.index()];
        u > 0.0 && g(u * u, v) < 0.0
    });
}

/// Errors of the layout must not grow with the number of faces between the loop vertex and the ends of the path.
#[test]
fn the_disc_of_a_fine_sheet_is_as_wide_as_its_texture_coordinates_say() {
    let scene = Scene::fold([-1.0, 0.8], [380, 60], |x, v| v - 0.4 - 0.2 * x);
    let (mesh, analysis) = assert_types(&scene, &[PairType::BoundaryLoopInside], &[PathType::BoundaryLoopInside]);
    let copy = &analysis.paths.copies[0];
    let [cu, cv] = scene.uvs[analysis.paths.pairs[0].loop_vertices[0].index()];
    let distance = |point: &PathPoint| {
        let weighted = |vertex: VertexId, weight: f64| scene.uvs[vertex.index()].map(|x| weight * x);
        let place = match point.own {
            SurfacePoint::Vertex(vertex) => scene.uvs[vertex.index()],
            SurfacePoint::Edge { edge, parameter } => {
                let [[au, av], [bu, bv]] = mesh.edge(edge).map(|vertex| scene.uvs[vertex.index()]);
                [au + parameter * (bu - au), av + parameter * (bv - av)]
            }
            SurfacePoint::Face { face, barycentric } => {
                let corners = mesh.face(face);
                let parts = [0, 1, 2].map(|corner| weighted(corners[corner], barycentric[corner]));
                [0, 1].map(|axis| parts.iter().map(|part| part[axis]).sum())
            }
        };
        (place[0] - cu).hypot(place[1] - cv)
    };
    let points = &analysis.paths.points[copy.points.clone()];
    let nearer = distance(&points[0]).min(distance(&points[points.len() - 1]));
    let radius = analysis.regions.by_copy[0].as_ref().unwrap().disc_radius.unwrap();
    assert!((radius - nearer).abs() < 1e-12, "radius {radius}, nearer end {nearer}");
}

/// A horizontal sheet and an upright one through it, `x` from `range`.
fn upright_through_flat(range: [f64; 2]) -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [21, 19], |x, y| [x, y, 0.013 * x * y]);
    scene.add_grid(range, [-0.3, 1.0], [12, 13], |x, z| [x, 0.07 * x + 0.03 * z, z]);
    scene
}

#[test]
fn the_end_of_a_strip_through_a_sheet_is_boundary_boundary() {
    let scene = upright_through_flat([-0.5, 0.4]);
    let types = [PathType::BoundaryBoundary, PathType::InsideInside];
    let found = assert_types(&scene, &[PairType::BoundaryBoundaryInsideInside], &types);
    // The strip was added last.
    assert_inside(&scene, &found, |vertex| vertex.index() >= 22 * 20 && scene.positions[vertex.index()][2] < 0.0);
}

#[test]
fn a_strip_through_the_edge_of_a_sheet_is_boundary_inside() {
    let scene = upright_through_flat([0.4, 1.6]);
    let (_, analysis) = assert_types(&scene, &[PairType::BoundaryInside], &[PathType::BoundaryInside; 2]);
    assert!(analysis.regions.by_copy.iter().all(Option::is_none));
}

#[test]
fn a_crease_that_ends_in_a_boundary_vertex_is_boundary_boundary_and_boundary_inside() {
    // As for BLI, but the curve meets the crease in the boundary.
    let scene = Scene::fold([-1.0, 0.8], [36, 30], |x, v| v - 0.6 * x);
    let types = [PathType::BoundaryBoundary, PathType::BoundaryInside];
    let found = assert_types(&scene, &[PairType::BoundaryBoundaryBoundaryInside], &types);
    let (mesh, analysis) = &found;
    assert!(mesh.is_boundary_vertex(analysis.paths.pairs[0].loop_vertices[0]));
    assert!(analysis.regions.by_copy[0].as_ref().is_some_and(|region| region.partitioning));
    // The BB path cuts off the corner under the curve, on the side where the sheet is shorter.
    assert_inside(&scene, &found, |vertex| {
        let [u, v] = scene.uvs[vertex.index()];
        u > 0.0 && v < 0.6 * u * u
    });
}

/// A flat sheet whose edges are x = -1 and x = 1, and an upright one with an edge at x = 1, which meet in (1, 0.25, 0): in numbers that are
/// exact in binary.
fn touching(left: f64, cells: u32) -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [8, 8], |x, y| [x, y, 0.0]);
    scene.add_grid([left, 1.0], [-0.5, 0.75], [cells, 5], |x, z| [x, 0.25 * x + 0.125 * z, z]);
    scene
}

/// The vertices of the upright sheet under the flat one: fewer than above.
fn is_under(scene: &Scene, vertex: VertexId) -> bool {
    vertex.index() >= 81 && scene.positions[vertex.index()][2] < 0.0
}

#[test]
fn boundaries_that_touch_exactly_are_both_ends() {
    let scene = touching(-0.5, 6);
    let types = [PathType::BoundaryBoundary, PathType::BoundaryInside];
    let found = assert_types(&scene, &[PairType::BoundaryBoundaryBoundaryInside], &types);
    assert!(found.1.regions.by_copy[0].as_ref().unwrap().partitioning);
    assert_inside(&scene, &found, |vertex| is_under(&scene, vertex));
}

#[test]
fn boundaries_that_touch_exactly_at_both_ends_are_boundary_boundary_twice() {
    let scene = touching(-1.0, 8);
    let found = assert_types(&scene, &[PairType::BoundaryBoundaryBoundaryBoundary], &[PathType::BoundaryBoundary; 2]);
    assert!(found.1.regions.by_copy.iter().all(|region| region.as_ref().unwrap().partitioning));
    // The flat sheet is cut along y = 0.25 x, in two parts of nearly the same size; which is smaller is counted.
    let beyond = |vertex: &VertexId| {
        let [x, y, _] = scene.positions[vertex.index()];
        vertex.index() < 81 && y > 0.25 * x
    };
    let num_beyond = found.0.vertex_ids().filter(beyond).count();
    let smaller = num_beyond < 81 - num_beyond;
    assert_inside(&scene, &found, |vertex| {
        if vertex.index() < 81 { beyond(&vertex) == smaller } else { is_under(&scene, vertex) }
    });
}

/// As for LL, but the sheet is slit open from the boundary across the path: the lips of the slit touch exactly.
#[test]
fn a_loop_loop_over_a_closed_slit_is_a_boundary_loop_loop_boundary() {
    let g = |x: f64, v: f64| (x / 0.5).powi(2) + ((v - 0.47) / 0.3).powi(2) - 1.0;
    let (nu, nv, row) = (40, 30, 14);
    let mut scene = Scene::fold([-1.0, 0.97], [nu, nv], g);
    // The row's vertices from u = 0.25 on get twins for the faces above it.
    let on_slit = |vertex: u32| vertex / (nu + 1) == row && scene.uvs[vertex as usize][0] > 0.25;
    let mut twins = std::collections::BTreeMap::new();
    for vertex in (0..(nu + 1) * (nv + 1)).filter(|&vertex| on_slit(vertex)).skip(1) {
        twins.insert(vertex, u32::try_from(scene.positions.len() + twins.len()).unwrap());
    }
    for (face, corners) in scene.faces.iter_mut().enumerate() {
        if u32::try_from(face).unwrap() / (2 * nu) >= row {
            corners.iter_mut().for_each(|corner| *corner = twins.get(corner).copied().unwrap_or(*corner));
        }
    }
    for &vertex in twins.keys() {
        scene.positions.push(scene.positions[vertex as usize]);
        scene.uvs.push(scene.uvs[vertex as usize]);
    }
    let (_, analysis) = analyse(&scene);
    let long: Vec<_> = analysis.paths.pairs.iter().filter(|pair| pair.length_m > 0.05).collect();
    assert_eq!(long.len(), 1);
    assert_eq!(long[0].pair_type, PairType::BoundaryLoopLoopBoundary);
    assert_eq!(long[0].loop_vertices.len(), 2);
    assert_eq!(long[0].copies.len(), 2);
    for copy in &analysis.paths.copies[long[0].copies.clone()] {
        let last = analysis.paths.arclengths_m(copy).last().unwrap();
        assert!(last > 0.1 && analysis.paths.arclengths_m(copy).is_sorted());
    }
}
