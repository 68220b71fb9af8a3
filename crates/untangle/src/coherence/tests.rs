//! Weights, turning and spreading.

use nalgebra::{Point3, Rotation3, Vector3};

use super::{Fade, RoughnessMeter, SparseField, Turns, spread};
use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription, VertexId},
};

const FADE: Fade = Fade { num_frames: 8 };

fn field(height: f64) -> SparseField {
    SparseField::from([(3, Vector3::new(0.0, 0.0, height))])
}

/// The heights of vertex 3 over 60 frames, spread from the frames given.
fn heights(repaired: &[(u64, f64)]) -> Vec<f64> {
    let fields: Vec<(u64, SparseField)> = repaired.iter().map(|&(frame, height)| (frame, field(height))).collect();
    let at = |frame| spread(frame, fields.iter().map(|(frame, field)| (*frame, field)), FADE);
    (0..60).map(|frame| at(frame).get(&3).map_or(0.0, |vector| vector.z)).collect()
}

fn ratio(heights: &[f64]) -> f64 {
    let mut meter = RoughnessMeter::new(FADE, 0.0);
    for &height in heights {
        meter.push(if height > 0.0 { field(height) } else { SparseField::new() });
    }
    meter.roughness().max_ratio_to_smooth.unwrap()
}

#[test]
fn spread_of_one_frame_is_its_correction_there_and_a_smooth_bump_round_it() {
    let heights = heights(&[(30, 0.02)]);
    assert!((heights[30] - 0.02).abs() < 1e-15);
    assert!(heights[..22].iter().chain(&heights[39..]).all(|height| *height <= 0.0));
    assert!(heights[22] > 0.0 && heights[38] > 0.0);
    assert!(heights[21..31].is_sorted() && heights[30..40].iter().rev().is_sorted());
    assert!(ratio(&heights) < 1.0, "{}", ratio(&heights));
    let alone: Vec<f64> = (0..60).map(|frame| if frame == 30 { 0.02 } else { 0.0 }).collect();
    assert!((ratio(&alone) - 2.0 * 81.0 / 5.7735).abs() < 0.01, "{}", ratio(&alone));
}

#[test]
fn spread_holds_in_short_gaps_and_is_smooth_across_long_ones() {
    for gap in 1..=8 {
        let heights = heights(&[(25, 0.02), (26 + gap, 0.02)]);
        let held = usize::try_from(gap).unwrap() + 26;
        assert!(heights[25..=held].iter().all(|height| (height - 0.02).abs() < 1e-15), "{gap}");
    }
    for gap in 1..20 {
        let heights = heights(&[(20, 0.02), (21 + gap, 0.02)]);
        // Where two fades overlap, both accelerations add up.
        assert!(ratio(&heights) < 2.0, "{gap}: {}", ratio(&heights));
    }
}

#[test]
fn spread_goes_over_smoothly_from_a_high_correction_to_a_low_one() {
    for gap in 6..20 {
        let run = |first: u64, height: f64| (first..first + 4).map(move |frame| (frame, height));
        let heights = heights(&run(15, 0.02).chain(run(19 + gap, 0.0005)).collect::<Vec<_>>());
        assert!(ratio(&heights) < 1.6, "{gap}: {} {heights:?}", ratio(&heights));
    }
}

#[test]
fn spread_of_a_run_that_jumps_is_far_smoother_than_the_run() {
    let run: Vec<(u64, f64)> = (20..40).map(|frame| (frame, if frame % 2 == 0 { 0.02 } else { 0.01 })).collect();
    let mut alone = vec![0.0; 60];
    run.iter().for_each(|&(frame, height)| alone[usize::try_from(frame).unwrap()] = height);
    let spread = heights(&run);
    assert!(ratio(&spread) < 1.3 && ratio(&alone) > 14.0, "{} {}", ratio(&spread), ratio(&alone));
}

#[test]
fn turns_carry_vectors_with_cloth_that_turns_and_stretches() {
    let positions: Vec<[f64; 3]> = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]];
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]];
    let mesh = Mesh::new(MeshDescription { num_vertices: 4, faces, ..Default::default() }).unwrap();
    let turn = Rotation3::new(Vector3::new(0.3, -1.2, 2.0));
    let moved: Vec<[f64; 3]> =
        positions.iter().map(|&at| (turn * (Point3::from(at) * 1.1) + Vector3::new(5.0, 0.0, 1.0)).into()).collect();
    let frame = Frame::new(&mesh, &moved).unwrap();
    let turns = Turns::new(&mesh, &positions, &frame);
    let vector = Vector3::new(0.1, 0.2, 0.3);
    for vertex in [0, 1, 2, 3].map(VertexId) {
        assert!((turns.to_frame(vertex, vector) - turn * vector).norm() < 1e-12);
        assert!((turns.to_material(vertex, turn * vector) - vector).norm() < 1e-12);
    }
}

#[test]
fn roughness_of_fewer_than_three_frames_is_not_measured() {
    let mut meter = RoughnessMeter::new(FADE, 0.0);
    for num_frames in 1..=4 {
        meter.push(field(0.25));
        let found = meter.roughness();
        assert_eq!((found.num_vertices, found.max_correction_m.to_bits()), (1, 0.25f64.to_bits()));
        let measured = [
            found.max_second_difference_m,
            found.max_ratio_to_smooth,
            found.p99_ratio_to_smooth,
            found.mean_ratio_to_smooth,
        ];
        assert_eq!(measured.map(|value| value.is_some()), [num_frames > 2; 4]);
    }
}
