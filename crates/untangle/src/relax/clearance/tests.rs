//! Small scenes whose gap is opened, or can't be.

#![expect(clippy::float_cmp, reason = "what does not move keeps its bits")]

use super::*;
use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
    proximity::{ProximityPair, ProximitySearch},
    relax::{Iteration, Method, RelaxSettings},
};

use std::ops::ControlFlow;

struct Scene {
    mesh: Mesh,
    positions: Vec<[f64; 3]>,
}

/// Sheets of `cells x cells` squares over the unit square, each at its own height.
fn sheets(cells: u32, heights: &[&dyn Fn(f64, f64) -> f64], pins: &[u32]) -> Scene {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (index, height) in heights.iter().enumerate() {
        let first = u32::try_from(positions.len()).unwrap();
        // Sheets that lie over each other are turned a bit, so that their edges cross.
        let turn = 0.11 * f64::from(u32::try_from(index).unwrap());
        for row in 0..=cells {
            for column in 0..=cells {
                let [x, y] = [column, row].map(|step| f64::from(step) / f64::from(cells) - 0.5);
                let place = [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()];
                positions.push([place[0], place[1], height(place[0], place[1])]);
            }
        }
        for row in 0..cells {
            for column in 0..cells {
                let at = first + row * (cells + 1) + column;
                faces.extend([[at, at + 1, at + cells + 2], [at, at + cells + 2, at + cells + 1]]);
            }
        }
    }
    let description =
        MeshDescription { num_vertices: positions.len(), faces, pins: pins.to_vec(), ..MeshDescription::default() };
    Scene { mesh: Mesh::new(description).unwrap(), positions }
}

fn open(scene: &Scene, gap_m: f64, settings: &RelaxSettings) -> Clearance {
    open_gap(&scene.mesh, &scene.positions, gap_m, settings, &mut |_| ControlFlow::Continue(()), &|| false).unwrap()
}

/// Pairs below the gap as the positions are, and rounded to single precision.
fn num_below(mesh: &Mesh, positions: &[[f64; 3]], gap_m: f64) -> [usize; 2] {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let rounded: Vec<[f64; 3]> = positions.iter().map(|point| point.map(|value| f64::from(value as f32))).collect();
    [positions, &rounded].map(|positions| {
        let mut found: Vec<ProximityPair> = Vec::new();
        let frame = Frame::new(mesh, positions).unwrap();
        ProximitySearch::default().find(mesh, &frame, gap_m, usize::MAX, &mut found);
        found.len()
    })
}

fn num_intersections(mesh: &Mesh, positions: &[[f64; 3]]) -> usize {
    let mut found = Intersections::default();
    Intersector::default().intersect(mesh, &Frame::new(mesh, positions).unwrap(), &mut found);
    found.edge_face.len()
}

/// The largest logarithm of an edge's length over that before.
fn largest_strain(scene: &Scene, after: &[[f64; 3]]) -> f64 {
    let length = |positions: &[[f64; 3]], [a, b]: [usize; 2]| {
        (0..3).map(|axis| (positions[b][axis] - positions[a][axis]).powi(2)).sum::<f64>().sqrt()
    };
    let ends = |edge| scene.mesh.edge(edge).map(|vertex| vertex.index());
    let strain = |edge| (length(after, ends(edge)) / length(&scene.positions, ends(edge))).ln().abs();
    scene.mesh.edge_ids().map(strain).fold(0.0, f64::max)
}

#[test]
fn open_gap_of_sheets_nearly_touching_sets_them_apart_at_every_resolution_and_scale() {
    for cells in [8, 16, 32] {
        // Gaps in parts of the edge of the coarsest sheet: the finer ones must do the same with shorter edges.
        for gap_m in [0.01 / 8.0, 0.1 / 8.0] {
            for scale in [1.0, 1e3] {
                // Convex above a plane, so that no chord of it reaches down.
                let below = |x: f64, y: f64| 0.1 * x - 0.05 * y;
                let above = |x: f64, y: f64| below(x, y) + 0.0003 + 0.002 * (x * x + y * y);
                let mut scene = sheets(cells, &[&below, &above], &[]);
                for value in scene.positions.as_flattened_mut() {
                    *value *= scale;
                }
                assert_eq!(num_intersections(&scene.mesh, &scene.positions), 0);
                let before = num_below(&scene.mesh, &scene.positions, gap_m * scale);
                let opened = open(&scene, gap_m * scale, &RelaxSettings::default());
                println!("{cells} {gap_m} {scale}: {before:?} {} iterations", opened.history.len());
                assert_eq!(opened.infeasible, []);
                assert_eq!((opened.num_pairs_below, opened.interrupted), (0, false));
                assert_eq!(num_below(&scene.mesh, &opened.positions, gap_m * scale), [0, 0]);
                assert_eq!(num_intersections(&scene.mesh, &opened.positions), 0);
                assert!(largest_strain(&scene, &opened.positions) < 0.25);
                assert!(before[0] > 0 && opened.history.iter().all(|step| step.method == Method::Gap));
                assert_eq!(opened.history.last().unwrap().num_pairs_below, Some(0));
            }
        }
    }
}

#[test]
fn open_gap_of_a_state_that_keeps_it_changes_no_bit() {
    let scene = sheets(6, &[&|_, _| 0.0, &|_, _| 0.1], &[]);
    let opened = open(&scene, 0.09, &RelaxSettings::default());
    assert_eq!((opened.history.len(), opened.positions), (0, scene.positions));
}

#[test]
fn open_gap_in_one_place_leaves_the_bits_of_vertices_far_from_it() {
    let bump = |x: f64, y: f64| 0.099 * (-200.0 * (x * x + y * y)).exp();
    let scene = sheets(24, &[&bump, &|_, _| 0.1], &[]);
    let opened = open(&scene, 0.004, &RelaxSettings::default());
    assert_eq!(opened.infeasible, []);
    let moved: Vec<f64> = scene
        .positions
        .iter()
        .zip(&opened.positions)
        .filter(|(before, after)| before != after)
        .map(|(before, _)| before[0].hypot(before[1]))
        .collect();
    assert!(!moved.is_empty() && moved.iter().all(|&radius| radius < 0.5), "{moved:?}");
}

#[test]
fn open_gap_in_single_precision_stores_single_numbers_that_keep_it() {
    let mut scene = sheets(8, &[&|_, _| 0.0, &|x, y| 0.0001 + 0.01 * x * y * x * y], &[]);
    for value in scene.positions.as_flattened_mut() {
        #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
        let rounded = (*value + 10.0) as f32;
        *value = f64::from(rounded);
    }
    let opened = open(&scene, 0.01, &RelaxSettings { single_precision: true, ..RelaxSettings::default() });
    assert_eq!(opened.infeasible, []);
    assert_eq!(num_below(&scene.mesh, &opened.positions, 0.01), [0, 0]);
    #[expect(clippy::cast_possible_truncation, reason = "they must be single already")]
    let is_single = opened.positions.iter().flatten().all(|&value| f64::from(value as f32) == value);
    assert!(is_single);
}

#[test]
fn open_gap_between_pinned_sheets_names_the_pinch_and_opens_the_rest() {
    // The middle sheet has no room between two pinned ones in its one half.
    let pins: Vec<u32> = (0..81).chain(162..243).collect();
    let room = |x: f64| 0.004 + 0.05 * x.max(0.0);
    let scene = sheets(8, &[&|_, _| 0.0, &|x, _| 0.5 * room(x), &|x, _| room(x)], &pins);
    assert_eq!(num_intersections(&scene.mesh, &scene.positions), 0);
    let opened = open(&scene, 0.01, &RelaxSettings::default());
    assert!(opened.num_pairs_below > 0);
    assert!(!opened.infeasible.is_empty());
    let obstacles: Vec<_> = opened.infeasible.iter().map(|place| place.obstacle).collect();
    assert!(obstacles.contains(&ClearanceObstacle::Pinned), "{obstacles:?}");
    assert!(
        obstacles.contains(&ClearanceObstacle::Held) || obstacles.contains(&ClearanceObstacle::PartlyPinned),
        "{obstacles:?}"
    );
    for place in &opened.infeasible {
        assert!(place.distance_m < 0.01 && place.vertices.is_sorted());
        let near = |&vertex: &u32| scene.positions[vertex as usize][0] < 0.3;
        assert!(place.vertices.iter().any(near), "{place:?}");
    }
    assert_eq!(num_intersections(&scene.mesh, &opened.positions), 0);
    assert!(largest_strain(&scene, &opened.positions) < 0.25);
    for &pin in &pins {
        assert_eq!(opened.positions[pin as usize], scene.positions[pin as usize]);
    }
}

#[test]
fn open_gap_larger_than_edges_leaves_neighbours_on_the_surface_alone() {
    let scene = sheets(10, &[&|_, _| 0.0], &[]);
    let opened = open(&scene, 0.12, &RelaxSettings::default());
    assert!(opened.num_pairs_below > 0);
    assert!(opened.infeasible.iter().any(|place| place.obstacle == ClearanceObstacle::Surface));
    println!("{:?}", opened.infeasible.iter().map(|place| (place.obstacle, place.num_pairs)).collect::<Vec<_>>());
    println!("{} iterations, strain {}", opened.history.len(), largest_strain(&scene, &opened.positions));
    assert!(largest_strain(&scene, &opened.positions) < 0.25);
}

#[test]
fn open_gap_as_large_as_the_mesh_that_is_stopped_looks_for_no_obstacle() {
    let scene = sheets(6, &[&|_, _| 0.0, &|_, _| 0.1], &[]);
    let mut progress = |_: &Iteration| ControlFlow::Continue(());
    let opened =
        open_gap(&scene.mesh, &scene.positions, 5.0, &RelaxSettings::default(), &mut progress, &|| true).unwrap();
    assert!(opened.interrupted && opened.positions == scene.positions && opened.num_pairs_below > 0);
    // Neighbours on the surface would have that reason, if they had been looked at.
    assert!(opened.infeasible.iter().all(|place| place.obstacle == ClearanceObstacle::Ended));
}

#[test]
fn open_gap_that_is_stopped_says_so_and_keeps_what_it_had() {
    let scene = sheets(8, &[&|_, _| 0.0, &|x, y| 0.0001 + 0.01 * x * y * x * y], &[]);
    let settings = RelaxSettings::default();
    let opened =
        open_gap(&scene.mesh, &scene.positions, 0.02, &settings, &mut |_| ControlFlow::Break(()), &|| false).unwrap();
    assert!(opened.interrupted && opened.history.len() == 1);
    assert_eq!(num_intersections(&scene.mesh, &opened.positions), 0);
    let opened =
        open_gap(&scene.mesh, &scene.positions, 0.02, &settings, &mut |_| ControlFlow::Continue(()), &|| true).unwrap();
    assert!(opened.interrupted && opened.positions == scene.positions);
    assert!(opened.infeasible.iter().all(|place| place.obstacle == ClearanceObstacle::Ended), "{opened:?}");
    let limited = open(&scene, 0.02, &RelaxSettings { max_iterations: 1, ..settings });
    assert!(limited.history.len() == 1 && !limited.interrupted);
}

#[test]
fn open_gap_of_touching_primitives_takes_the_side_of_exact_signs() {
    // A vertex exactly in a face: to exact signs it lies on one side.
    let positions =
        vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.5, 3.0], [1.5, 1.0, 3.0]];
    for order in [[0, 1, 2, 3, 4, 5], [3, 4, 5, 0, 1, 2]] {
        let mut placed = vec![[0.0; 3]; 6];
        for (vertex, position) in order.into_iter().zip(&positions) {
            placed[vertex] = *position;
        }
        let faces = vec![[0, 1, 2], [3, 4, 5]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
        let scene = Scene { mesh, positions: placed };
        if num_intersections(&scene.mesh, &scene.positions) > 0 {
            continue;
        }
        let opened = open(&scene, 0.1, &RelaxSettings::default());
        assert_eq!(num_below(&scene.mesh, &opened.positions, 0.1), [0, 0]);
        assert_eq!(num_intersections(&scene.mesh, &opened.positions), 0);
    }
}

#[test]
fn open_gap_beside_a_tangle_sets_apart_what_is_far_from_it_and_names_the_rest() {
    // Two sheets that are close everywhere, and cross in a corner.
    let scene = sheets(24, &[&|_, _| 0.0, &|x, y| 0.001 - 0.4 * (0.3 - (0.4 - x).hypot(0.4 - y)).clamp(0.0, 0.1)], &[]);
    let before = num_below(&scene.mesh, &scene.positions, 0.002)[0];
    let tangle = num_intersections(&scene.mesh, &scene.positions);
    assert!(tangle > 0);
    let opened = open(&scene, 0.002, &RelaxSettings::default());
    assert!(opened.num_pairs_below > 0 && 2 * opened.num_pairs_below < before, "{} {before}", opened.num_pairs_below);
    assert_eq!(num_intersections(&scene.mesh, &opened.positions), tangle);
    let obstacles: Vec<_> = opened.infeasible.iter().map(|place| (place.obstacle, place.num_pairs)).collect();
    assert!(opened.infeasible.iter().all(|place| place.obstacle == ClearanceObstacle::Tangled), "{obstacles:?}");
}
