//! Sheets, atlases, a cone and a band with one side.

use nalgebra::Point2;

use super::Unfolding;
use crate::{
    correspond::{
        charts::{patch::Patch, shapes::Shape},
        samples::{sheet, sheet_faces},
    },
    mesh::{Mesh, MeshDescription},
};

fn whole_mesh(mesh: &Mesh) -> Patch {
    let mut patch = Patch::default();
    patch.start(mesh, mesh.face_ids());
    patch.connect(mesh);
    patch
}

fn shapes_of(patch: &Patch, points: &[Point2<f64>]) -> Vec<Shape> {
    patch.corners().iter().map(|c| c.map(|v| points[patch.vertices()[v as usize].index()])).collect()
}

fn distance_error(patch: &Patch, unfolding: &Unfolding, flat: &[Point2<f64>], scale: f64) -> f64 {
    let first = flat[patch.vertices()[0].index()];
    let mut worst: f64 = 0.0;
    for (vertex, point) in patch.vertices().iter().zip(&unfolding.points) {
        let expected = (flat[vertex.index()] - first).norm() * scale;
        worst = worst.max(((point - unfolding.points[0]).norm() - expected).abs());
    }
    worst
}

#[test]
fn unfold_of_flat_sheet_with_mixed_winding_is_the_sheet() {
    let (_, flat) = sheet(6, 5, 0.1);
    let mut faces = sheet_faces(6, 5);
    for face in faces.iter_mut().step_by(3) {
        face.swap(1, 2);
    }
    let mesh = Mesh::new(MeshDescription { num_vertices: flat.len(), faces, ..Default::default() }).unwrap();
    let patch = whole_mesh(&mesh);
    let shapes = shapes_of(&patch, &flat);
    let mut unfolding = Unfolding::default();
    assert!(unfolding.unfold(&patch, &shapes));
    assert!(unfolding.misfit < 1e-12);
    assert!(distance_error(&patch, &unfolding, &flat, 1.0) < 1e-12);
}

#[test]
fn unfold_across_seam_of_atlas_joins_the_panels() {
    let (mesh, flat) = sheet(6, 5, 0.1);
    let patch = whole_mesh(&mesh);
    let mut shapes = shapes_of(&patch, &flat);
    // The right half is another panel: mirrored, turned, half as large, elsewhere.
    for shape in &mut shapes {
        if shape.iter().map(|p| p.x).sum::<f64>() > 0.9 {
            *shape = shape.map(|p| Point2::new(7.0 + 0.5 * p.y, 3.0 + 0.5 * p.x));
        }
    }
    let mut unfolding = Unfolding::default();
    assert!(unfolding.unfold(&patch, &shapes));
    assert!(unfolding.misfit < 1e-12);
    assert!(distance_error(&patch, &unfolding, &flat, 1.0) < 1e-12);
}

/// An equilateral triangle.
fn equilateral() -> Shape {
    [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.5, 0.75f64.sqrt())]
}

#[test]
fn unfold_of_cone_leaves_a_misfit() {
    // Five equilateral triangles round a vertex.
    let faces = (0..5).map(|k| [5, k, (k + 1) % 5]).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
    let mut unfolding = Unfolding::default();
    assert!(unfolding.unfold(&whole_mesh(&mesh), &[equilateral(); 5]));
    assert!(unfolding.misfit > 0.2, "{}", unfolding.misfit);
}

#[test]
fn unfold_of_moebius_band_fails() {
    let faces = vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
    let mesh = Mesh::new(MeshDescription { num_vertices: 5, faces, ..Default::default() }).unwrap();
    assert!(!Unfolding::default().unfold(&whole_mesh(&mesh), &[equilateral(); 5]));
}
