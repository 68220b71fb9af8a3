//! Domes and annuli, which no unfolding lays flat.

use nalgebra::Point3;

use super::ArapParameterization;
use crate::{
    correspond::{
        charts::{
            patch::Patch,
            shapes::{Shape, sides_of},
            unfolding::Unfolding,
        },
        samples::{sheet_faces, tube_faces},
    },
    geometry::flat_triangle,
    mesh::{Mesh, MeshDescription},
};

/// The largest relative change of an edge, and whether every face has the same winding.
fn quality(patch: &Patch, shapes: &[Shape], unfolding: &Unfolding) -> (f64, bool) {
    let mut worst: f64 = 0.0;
    let mut windings = [0, 0];
    for (corners, shape) in patch.corners().iter().zip(shapes) {
        let lies = corners.map(|vertex| unfolding.points[vertex as usize]);
        for (a, b) in sides_of(&lies).iter().zip(&sides_of(shape)) {
            worst = worst.max((a.norm() / b.norm()).ln().abs());
        }
        windings[usize::from((lies[1] - lies[0]).perp(&(lies[2] - lies[0])) > 0.0)] += 1;
    }
    (worst, windings.contains(&0))
}

/// Flattens a mesh: the largest relative change of an edge, whether no face is folded over, and the misfit of the
/// unfolding before.
fn flattened(num_vertices: usize, faces: Vec<[u32; 3]>, at: impl Fn(usize) -> Point3<f64>) -> (f64, bool, f64) {
    let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
    let mut patch = Patch::default();
    patch.start(&mesh, mesh.face_ids());
    patch.connect(&mesh);
    let vertices = patch.vertices();
    let shape = |corners: &[u32; 3]| flat_triangle(corners.map(|vertex| at(vertices[vertex as usize].index())));
    let shapes: Vec<Shape> = patch.corners().iter().map(shape).collect();
    let mut unfolding = Unfolding::default();
    assert!(unfolding.unfold(&patch, &shapes));
    let misfit = unfolding.misfit;
    assert!(ArapParameterization::default().flatten(&patch, &shapes, true, &mut unfolding));
    let (worst, is_injective) = quality(&patch, &shapes, &unfolding);
    (worst, is_injective, misfit)
}

#[test]
fn flatten_of_dome_strains_little_and_folds_nothing() {
    let (worst, is_injective, misfit) = flattened(81, sheet_faces(8, 8), |vertex| {
        let (x, y) = (vertex % 9, vertex / 9);
        let (x, y) = (x as f64 / 8.0 - 0.5, y as f64 / 8.0 - 0.5);
        Point3::new(x, y, 0.6 * (0.6 - x * x - y * y))
    });
    assert!(misfit > 0.05, "{misfit}");
    assert!(is_injective && worst < 0.1, "{worst}");
}

#[test]
fn flatten_of_ring_of_cone_is_an_annulus() {
    // Closed in one direction: 24 columns, 4 rows of vertices of a steep frustum.
    let (worst, is_injective, misfit) = flattened(96, tube_faces(24, 3), |vertex| {
        let (column, row) = (vertex % 24, vertex / 24);
        let angle = column as f64 / 24.0 * std::f64::consts::TAU;
        let radius = 1.0 + 0.2 * row as f64;
        Point3::new(radius * angle.cos(), radius * angle.sin(), 0.1 * row as f64)
    });
    assert!(misfit > 0.1, "{misfit}");
    assert!(is_injective && worst < 0.2, "{worst}");
}
