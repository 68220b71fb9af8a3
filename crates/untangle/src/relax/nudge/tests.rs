//! Nudges, on hems of several finenesses.

use std::ops::ControlFlow;

use nalgebra::Point3;

use super::*;
use crate::{
    mesh::{Mesh, MeshDescription},
    relax::settings::RelaxSettings,
};

/// Of the hem above the sheet, and of its middle below it.
const DEPTH_M: f64 = 0.02;

/// A sheet of `size` x `size` squares whose hem is folded back over it, but for the middle of the hem, which has
/// gone through.
fn hem(size: u32) -> (Mesh, Vec<[f64; 3]>) {
    let row = size + 1;
    let edge = 1.0 / f64::from(size);
    let mut positions = Vec::new();
    for step in 0..=size {
        for column in 0..=size {
            // The last row is the hem, not far from the row two before it.
            let is_hem = step == size;
            let y = f64::from(step) * edge - if is_hem { 1.6 * edge } else { 0.0 };
            positions.push([f64::from(column) * edge, y, if is_hem { DEPTH_M } else { 0.0 }]);
        }
    }
    let middle = size * row + size / 2;
    positions[middle as usize][2] = -DEPTH_M;
    let corner = |index: u32| index / size * row + index % size;
    let two = |a: u32| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]];
    let faces = (0..size * size).flat_map(|index| two(corner(index))).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
    (mesh, positions)
}

#[test]
fn nudge_of_a_hem_that_goes_through_its_sheet_by_a_vertex_moves_two_vertices_at_most_at_any_resolution() {
    for size in [8, 16, 32] {
        clears(size);
    }
}

fn clears(size: u32) {
    let (mesh, positions) = hem(size);
    let settings = RelaxSettings::default();
    let mut relaxer = Relaxer::new(&mesh, &positions, &settings, &|| false).unwrap();
    let start = relaxer.frame.positions().to_vec();
    relaxer.set_frame(&start).unwrap();
    relaxer.measure_islands(0);
    let merit = total(&relaxer.now).merit();
    assert!(merit > 0.0);
    let mut best = BestState { merit, positions: start.clone() };
    let end = nudge(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(end, End::Clean);
    let moved: Vec<usize> = (0..start.len()).filter(|&index| start[index] != best.positions[index]).collect();
    assert!((1..=2).contains(&moved.len()), "{moved:?}");
    stays_where_all_is_pinned(&mesh, &start, merit);
}

fn stays_where_all_is_pinned(mesh: &Mesh, positions: &[Point3<f64>], merit: f64) {
    let pins = (0..positions.len()).filter_map(|index| u32::try_from(index).ok()).collect();
    let faces = mesh.face_ids().map(|face| mesh.face(face).map(|corner| corner.0)).collect();
    let held = MeshDescription { num_vertices: positions.len(), faces, pins, ..Default::default() };
    let held = Mesh::new(held).unwrap();
    let start: Vec<[f64; 3]> = positions.iter().map(|at| (*at).into()).collect();
    let settings = RelaxSettings::default();
    let mut relaxer = Relaxer::new(&held, &start, &settings, &|| false).unwrap();
    let mut best = BestState { merit, positions: positions.to_vec() };
    nudge(&mut relaxer, &mut best, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(best.positions, positions);
}
