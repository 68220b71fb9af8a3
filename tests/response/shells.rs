//! The relaxation of cloth with two sides, and of closed pieces.

use std::{f64::consts::TAU, ops::ControlFlow};

use nalgebra::Point3;
use untangle::{
    mesh::{Mesh, MeshDescription},
    relax::{RelaxSettings, relax},
};
use untangled_checker::count_edge_face;
use untangled_testkit::generate::Sheet;

/// Relaxes, and gives back the positions of a state in which nothing touches.
fn relaxed(faces: &[[u32; 3]], positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let num_vertices = positions.len();
    let mesh = Mesh::new(MeshDescription { num_vertices, faces: faces.to_vec(), ..Default::default() }).unwrap();
    let settings = RelaxSettings::default();
    assert!(count_edge_face(positions, faces).unwrap() > 0);
    let relaxation = relax(&mesh, positions, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(count_edge_face(&relaxation.positions, faces), Ok(0));
    relaxation.positions
}

fn farthest_m(before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let moves = before.iter().zip(after).map(|(a, b)| (Point3::from(*b) - Point3::from(*a)).norm());
    moves.fold(0.0, f64::max)
}

#[test]
fn relax_of_two_opposite_faces_on_the_same_vertices_separates_them_as_single_ones() {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [12, 12], |u, v| [u, v, 0.01 * (9.0 * u + 4.0 * v).sin()]);
    sheet.add_grid([-0.3, 0.31], [-0.43, 0.6], [4, 7], |u, v| [u, 0.02 + 0.1 * u + 0.05 * v, v]);
    let single = farthest_m(&sheet.positions, &relaxed(&sheet.faces, &sheet.positions));
    let backs = sheet.faces.iter().map(|&[a, b, c]| [a, c, b]);
    let faces: Vec<[u32; 3]> = sheet.faces.iter().copied().chain(backs).collect();
    let double = farthest_m(&sheet.positions, &relaxed(&faces, &sheet.positions));
    assert!(double < 2.0 * single, "{double} m at most, {single} m with single faces");
}

#[test]
fn relax_of_a_tube_that_lies_in_a_sphere_turns_no_triangle_over() {
    let mut sheet = Sheet::default();
    let round = |radius: f64, turn: f64, z: f64| [radius * (TAU * turn).cos(), radius * (TAU * turn).sin(), z];
    sheet.add_grid([0.0, 0.97], [-0.9, 0.9], [24, 14], |u, v| round((1.0 - v * v).sqrt(), u, v));
    sheet.add_grid([0.02, 0.94], [-0.25, 0.25], [24, 5], |u, v| round(0.985, u, v));
    let after = relaxed(&sheet.faces, &sheet.positions);
    // Half an edge, and room for the sheets to give way.
    let edge_m = TAU / 24.0;
    assert!(farthest_m(&sheet.positions, &after) < edge_m, "{} m", farthest_m(&sheet.positions, &after));
    for face in &sheet.faces {
        let normal = |positions: &[[f64; 3]]| {
            let [a, b, c] = face.map(|vertex| Point3::from(positions[vertex as usize]));
            (b - a).cross(&(c - a))
        };
        assert!(normal(&sheet.positions).dot(&normal(&after)) > 0.0, "{face:?} is turned over");
    }
}
