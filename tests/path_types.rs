//! One generated scene for each type of intersection path, with the answer that the definitions give.
//!
//! Folded sheets: `f(u, v) = (u^2, v, a tanh(u / e) g(u^2, v))`. The layers `u` and `-u` meet exactly where `g = 0`, and the sheet meets
//! itself in one point, a loop vertex, where that curve reaches the crease `u = 0`. So the paths in the parameter domain are known
//! beforehand, and with them their types and inside regions. The other scenes are flat sheets placed through each other.

#![allow(clippy::unwrap_used, reason = "a test")]

use untangled::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs, VertexId},
    paths::{PairType, PathPoint, PathType, SurfacePoint},
};

/// A scene with its parameter domain.
#[derive(Default)]
struct Scene {
    positions: Vec<[f64; 3]>,
    uvs: Vec<[f64; 2]>,
    faces: Vec<[u32; 3]>,
}

impl Scene {
    /// Adds a grid over `[u0, u1] x [v0, v1]`, placed by `place`. The rows are slightly slanted, so that nothing is aligned but what
    /// the scene aligns.
    fn add_grid(
        &mut self,
        [u0, u1]: [f64; 2],
        [v0, v1]: [f64; 2],
        [nu, nv]: [u32; 2],
        place: impl Fn(f64, f64) -> [f64; 3],
    ) {
        let first = u32::try_from(self.positions.len()).unwrap();
        for j in 0..=nv {
            for i in 0..=nu {
                let u = u0 + (u1 - u0) * f64::from(i) / f64::from(nu);
                let v = v0 + (v1 - v0) * f64::from(j) / f64::from(nv);
                self.uvs.push([u, v]);
                self.positions.push(place(u, v));
            }
        }
        for j in 0..nv {
            for i in 0..nu {
                let at = |di: u32, dj: u32| first + (j + dj) * (nu + 1) + i + di;
                self.faces.push([at(0, 0), at(1, 0), at(1, 1)]);
                self.faces.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }

    /// A folded sheet whose layers meet where `g(u^2, v)` vanishes.
    fn fold(domain_u: [f64; 2], cells: [u32; 2], g: impl Fn(f64, f64) -> f64) -> Self {
        let mut scene = Self::default();
        scene.add_grid(domain_u, [0.0, 1.0], cells, |u, v| {
            let x = u * u;
            [x, v, 0.3 * (u / 0.3).tanh() * g(x, v)]
        });
        scene
    }

    fn analyse(&self) -> (Mesh, Analysis) {
        let uvs = Uvs { coordinates: self.uvs.clone(), corners: self.faces.clone() };
        let description = MeshDescription {
            num_vertices: self.positions.len(),
            faces: self.faces.clone(),
            uvs: Some(uvs),
            ..Default::default()
        };
        let mesh = Mesh::new(description).unwrap();
        let frame = Frame::new(&mesh, &self.positions).unwrap();
        let analysis = analyse(&mesh, &frame);
        (mesh, analysis)
    }
}

/// Asserts the types of all pairs, and returns mesh and analysis for more.
#[track_caller]
fn assert_types(scene: &Scene, pairs: &[PairType], copies: &[PathType]) -> (Mesh, Analysis) {
    let (mesh, analysis) = scene.analyse();
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
    let mut found: Vec<VertexId> = analysis.regions.vertices.clone();
    found.sort();
    found.dedup();
    assert!(!found.is_empty());
    let mut num_checked = 0;
    for vertex in mesh.vertex_ids() {
        let expected = inside(vertex);
        let mut neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
        if neighbours.all(|neighbour| inside(neighbour) == expected) {
            let [u, v] = scene.uvs[vertex.index()];
            assert_eq!(found.binary_search(&vertex).is_ok(), expected, "vertex {} at ({u}, {v})", vertex.0);
            num_checked += usize::from(expected);
        }
    }
    assert!(num_checked > 0, "the scene has no vertex well inside");
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
    let (_, analysis) = assert_types(&scene, &[PairType::BoundaryLoopInside], &[PathType::BoundaryLoopInside]);
    let region = analysis.regions.by_copy[0].as_ref().unwrap();
    assert!(region.partitioning);
    // Both ends lie on u = 0.8 and u = -0.8, 0.2 * 0.64 higher than the loop vertex.
    let radius = region.disc_radius.unwrap();
    assert!((radius - 0.8f64.hypot(0.2 * 0.64)).abs() < 0.05, "radius {radius}");
    assert_eq!(analysis.paths.pairs[0].loop_vertices.len(), 1);
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
    let (mesh, analysis) = scene.analyse();
    let types: Vec<_> = analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect();
    assert_eq!(types, [PairType::BoundaryBoundaryBoundaryInside]);
    assert!(mesh.is_boundary_vertex(analysis.paths.pairs[0].loop_vertices[0]));
    assert!(analysis.regions.by_copy[0].as_ref().is_some_and(|region| region.partitioning));
}

/// Two crossing sheets whose path ends where a corner of each touches the other, in numbers that are exact in binary.
#[test]
fn boundaries_that_touch_exactly_are_both_ends() {
    let mut scene = Scene::default();
    // The flat sheet's edge x = 1 and the upright sheet's edge x = 1 meet in (1, 0.25, 0) and nowhere else.
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [8, 8], |x, y| [x, y, 0.0]);
    scene.add_grid([-0.5, 1.0], [-0.5, 0.75], [6, 5], |x, z| [x, 0.25 * x + 0.125 * z, z]);
    let (_, analysis) = scene.analyse();
    let types: Vec<_> = analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect();
    assert_eq!(types, [PairType::BoundaryBoundaryBoundaryInside]);
    let region = analysis.regions.by_copy[0].as_ref().unwrap();
    assert!(region.partitioning && !region.vertices.is_empty());
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
    let (_, analysis) = scene.analyse();
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
