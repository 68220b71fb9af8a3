//! Folded sheets, one for each type of path that they can have.
//!
//! The sheets are `f(u, v) = (u^2, v, a tanh(u / e) g(u^2, v))`. The layers `u` and `-u` meet exactly where `g = 0`,
//! and the sheet meets itself in one point, a loop vertex, where that curve reaches the crease `u = 0`. So the paths in
//! the parameter domain are known beforehand, and with them their types and inside regions.

use untangle::{
    mesh::VertexId,
    paths::{PairType, PathPoint, PathType, SurfacePoint},
};
use untangled_testkit::generate::{Sheet, folded};

use super::expect::{analyse, assert_disc, assert_inside, assert_types};

#[test]
fn path_of_a_closed_curve_over_the_crease_is_loop_loop() {
    let g = |x: f64, v: f64| (x / 0.5).powi(2) + ((v - 0.5) / 0.3).powi(2) - 1.0;
    let sheet = Sheet::fold([-1.0, 0.97], [40, 31], g);
    let found = assert_types(&sheet, &[PairType::LoopLoop], &[PathType::LoopLoop]);
    assert_eq!(found.1.paths.pairs[0].loop_vertices.len(), 2);
    assert_inside(&sheet, &found, |vertex| {
        let [u, v] = sheet.uvs[vertex.index()];
        g(u * u, v) < 0.0
    });
}

#[test]
fn path_from_the_boundary_over_the_crease_is_boundary_loop_inside() {
    // The sheet is shorter on one side of the crease: there the curve reaches the boundary, on the other side it ends
    // inside.
    let sheet = Sheet::fold([-1.0, 0.8], [40, 31], |x, v| v - 0.4 - 0.2 * x);
    let found = assert_types(&sheet, &[PairType::BoundaryLoopInside], &[PathType::BoundaryLoopInside]);
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
        sheet.uvs.iter().filter(is_there).count()
    };
    let smaller = count(true) < count(false);
    assert_disc(&sheet, &found, [0.0, 0.4], expected, |uv| above(uv) == smaller);
}

/// The sheet is as long on both sides of the crease: both copies end in the boundary, where its two ends touch exactly.
/// The columns between differ, so that nothing else does.
#[test]
fn path_over_the_crease_to_touching_boundaries_is_boundary_loop_boundary() {
    let us: Vec<f64> =
        (-19..=0).map(|i| f64::from(i) * 0.75 / 19.0).chain((1..=17).map(|i| f64::from(i) * 0.75 / 17.0)).collect();
    let vs: Vec<f64> = (0..=31).map(|j| f64::from(j) / 31.0).collect();
    let mut sheet = Sheet::default();
    sheet.add_lines(&us, &vs, folded(|x, v| v - 0.4 - 0.2 * x));
    let found = assert_types(&sheet, &[PairType::BoundaryLoopBoundary], &[PathType::BoundaryLoopBoundary]);
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
    let [cu, cv] = sheet.uvs[paths.pairs[0].loop_vertices[0].index()];
    let expected = 0.75f64.hypot(0.4 + 0.2 * 0.75 * 0.75 - cv);
    assert!((region.disc_radius.unwrap() - expected).abs() < 1e-9 && cu.abs() <= 0.0);
    let above = |[u, v]: [f64; 2]| v > 0.4 + 0.2 * u * u;
    let count = |side: bool| {
        let is_there = |&&[u, v]: &&[f64; 2]| u.hypot(v - cv) < expected && above([u, v]) == side;
        sheet.uvs.iter().filter(is_there).count()
    };
    let smaller = count(true) < count(false);
    assert_disc(&sheet, &found, [cu, cv], expected, |uv| above(uv) == smaller);
}

#[test]
fn path_of_a_drop_that_touches_the_crease_is_eight() {
    // A vertex stands in the tip of the drop.
    let g = |x: f64, v: f64| (v - 0.5).powi(2) - x * x * (0.6 - x);
    let sheet = Sheet::fold([-1.0, 1.0], [36, 36], g);
    let found = assert_types(&sheet, &[PairType::Eight], &[PathType::Closed; 2]);
    assert_inside(&sheet, &found, |vertex| {
        let [u, v] = sheet.uvs[vertex.index()];
        g(u * u, v) < 0.0
    });
}

#[test]
fn path_of_a_wedge_that_starts_at_the_crease_is_cross() {
    let g = |x: f64, v: f64| (v - 0.5).powi(2) - 0.09 * x * x;
    let sheet = Sheet::fold([-1.0, 0.9], [38, 36], g);
    let found = assert_types(&sheet, &[PairType::Cross], &[PathType::BoundaryBoundary, PathType::InsideInside]);
    // On the short side both curves reach the boundary: the wedge there is inside.
    assert_inside(&sheet, &found, |vertex| {
        let [u, v] = sheet.uvs[vertex.index()];
        u > 0.0 && g(u * u, v) < 0.0
    });
}

/// Errors of the layout must not grow with the number of faces between the loop vertex and the ends of the path.
#[test]
fn disc_radius_of_a_fine_sheet_equals_the_distance_in_texture_coordinates() {
    let sheet = Sheet::fold([-1.0, 0.8], [380, 60], |x, v| v - 0.4 - 0.2 * x);
    let (mesh, analysis) = assert_types(&sheet, &[PairType::BoundaryLoopInside], &[PathType::BoundaryLoopInside]);
    let copy = &analysis.paths.copies[0];
    let [cu, cv] = sheet.uvs[analysis.paths.pairs[0].loop_vertices[0].index()];
    let distance = |point: &PathPoint| {
        let weighted = |vertex: VertexId, weight: f64| sheet.uvs[vertex.index()].map(|x| weight * x);
        let place = match point.own {
            SurfacePoint::Vertex(vertex) => sheet.uvs[vertex.index()],
            SurfacePoint::Edge { edge, parameter } => {
                let [[au, av], [bu, bv]] = mesh.edge(edge).map(|vertex| sheet.uvs[vertex.index()]);
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

#[test]
fn path_from_a_crease_end_on_the_boundary_is_boundary_boundary_and_boundary_inside() {
    // As for BLI, but the curve meets the crease in the boundary.
    let sheet = Sheet::fold([-1.0, 0.8], [36, 30], |x, v| v - 0.6 * x);
    let types = [PathType::BoundaryBoundary, PathType::BoundaryInside];
    let found = assert_types(&sheet, &[PairType::BoundaryBoundaryBoundaryInside], &types);
    let (mesh, analysis) = &found;
    assert!(mesh.is_boundary_vertex(analysis.paths.pairs[0].loop_vertices[0]));
    assert!(analysis.regions.by_copy[0].as_ref().is_some_and(|region| region.partitioning));
    // The BB path cuts off the corner under the curve, on the side where the sheet is shorter.
    assert_inside(&sheet, &found, |vertex| {
        let [u, v] = sheet.uvs[vertex.index()];
        u > 0.0 && v < 0.6 * u * u
    });
}

/// As for LL, but the sheet is slit open from the boundary across the path: the lips of the slit touch exactly.
#[test]
fn path_over_a_closed_slit_is_boundary_loop_loop_boundary() {
    let g = |x: f64, v: f64| (x / 0.5).powi(2) + ((v - 0.47) / 0.3).powi(2) - 1.0;
    let (nu, nv, row) = (40, 30, 14);
    let mut sheet = Sheet::fold([-1.0, 0.97], [nu, nv], g);
    // The row's vertices from u = 0.25 on get twins for the faces above it.
    let on_slit = |vertex: u32| vertex / (nu + 1) == row && sheet.uvs[vertex as usize][0] > 0.25;
    let mut twins = std::collections::BTreeMap::new();
    for vertex in (0..(nu + 1) * (nv + 1)).filter(|&vertex| on_slit(vertex)).skip(1) {
        twins.insert(vertex, u32::try_from(sheet.positions.len() + twins.len()).unwrap());
    }
    for (face, corners) in sheet.faces.iter_mut().enumerate() {
        if u32::try_from(face).unwrap() / (2 * nu) >= row {
            corners.iter_mut().for_each(|corner| *corner = twins.get(corner).copied().unwrap_or(*corner));
        }
    }
    for &vertex in twins.keys() {
        sheet.positions.push(sheet.positions[vertex as usize]);
        sheet.uvs.push(sheet.uvs[vertex as usize]);
    }
    let (_, analysis) = analyse(&sheet);
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
