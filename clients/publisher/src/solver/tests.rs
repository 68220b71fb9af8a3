use untangled_checker::count_edge_face;

use super::{Help, Parameters, Solver};
use crate::{
    mesh::{Cloth, Vec3},
    scenes::{Pin, Sheet},
};

fn parameters(gravity: f64) -> Parameters {
    Parameters {
        gravity_m_s2: Vec3::new(0.0, 0.0, -gravity),
        density_kg_m2: 0.2,
        stretch_n_m: 1e3,
        bending_n_m: 1e-4,
        drag_1_s: 3.0,
        thickness_m: 0.01,
        friction: 0.0,
        num_substeps: 4,
        single_precision: true,
    }
}

/// A sheet of 0.5 m, its boundary pinned, and a smaller one that lies `height` above it.
fn two_sheets(height: f64) -> Cloth {
    let mut cloth = Sheet::new(0.5, 0.5, 0.05).pinned(Pin::Boundary).build(1, |u, v| Vec3::new(u, v, 0.0));
    cloth
        .append(Sheet::new(0.3, 0.3, 0.05).build(2, move |u, v| Vec3::new(u, v, height)), Vec3::new(0.103, 0.107, 0.0));
    cloth
}

#[test]
fn step_of_a_sheet_at_rest_without_forces_moves_nothing() {
    let cloth = Sheet::new(0.5, 0.5, 0.05).build(1, |u, v| Vec3::new(u, v, 0.0));
    let mut solver = Solver::new(cloth.clone(), parameters(0.0));
    for _ in 0..20 {
        solver.step(1.0 / 60.0, Help::NONE);
    }
    for (now, before) in solver.cloth().positions.iter().zip(&cloth.positions) {
        assert!((now - before).norm() < 1e-5, "{before} moved to {now}");
    }
}

#[test]
fn step_rounds_to_single_precision_only_when_asked() {
    for single_precision in [true, false] {
        let cloth = Sheet::new(0.5, 0.5, 0.05).build(1, |u, v| Vec3::new(u, v, 0.0));
        let mut solver = Solver::new(cloth, Parameters { single_precision, ..parameters(9.81) });
        solver.step(1.0 / 60.0, Help::NONE);
        let mut rounded = solver.cloth().clone();
        rounded.round_to_f32();
        assert_eq!(rounded == *solver.cloth(), single_precision);
    }
}

/// Contact looks half an edge ahead, 0.025 m, and is looked for again as often as that takes.
#[test]
fn sheet_pushed_over_many_edges_in_a_step_gets_there_and_is_held_by_contact() {
    let height = 0.2;
    let mut solver = Solver::new(two_sheets(height), parameters(0.0));
    let num_lower = 11 * 11;
    let is_upper = |vertex: usize| vertex >= num_lower;
    let push = |vertex: usize| if is_upper(vertex) { Vec3::new(0.0, 0.0, -5.0) } else { Vec3::zeros() };
    let pushes: Vec<Vec3> = (0..solver.cloth().positions.len()).map(push).collect();
    let lowest = |solver: &Solver| {
        solver.cloth().positions[num_lower..].iter().map(|position| position.z).fold(f64::INFINITY, f64::min)
    };
    solver.step(1.0 / 60.0, Help { velocity_change_m_s: &pushes, ..Help::NONE });
    assert!(height - lowest(&solver) > 0.04, "it came {} m", height - lowest(&solver));
    for _ in 0..10 {
        solver.step(1.0 / 60.0, Help::NONE);
        let Cloth { triangles, .. } = solver.cloth();
        assert_eq!(count_edge_face(&solver.cloth().points(), triangles).unwrap(), 0);
    }
}

#[test]
fn contact_holds_a_falling_sheet_unless_it_is_masked() {
    for masked in [false, true] {
        let mut solver = Solver::new(two_sheets(0.03), parameters(9.81));
        let num_vertices = solver.cloth().positions.len();
        let no_contact = vec![masked; num_vertices];
        for _ in 0..60 {
            solver.step(1.0 / 60.0, Help { no_contact: &no_contact, ..Help::NONE });
        }
        let lowest = |range: &[Vec3]| range.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        let (below, above) = solver.cloth().positions.split_at(11 * 11);
        assert_eq!(lowest(above) < lowest(below), masked, "masked: {masked}");
        if !masked {
            assert_eq!(count_edge_face(&solver.cloth().points(), &solver.cloth().triangles), Ok(0));
        }
    }
}

#[test]
fn contact_keeps_a_tangle_that_it_starts_from() {
    // The upper sheet dips through the lower one.
    let dip = |u: f64, v: f64| {
        let r2 = (u - 0.15).powi(2) + (v - 0.15).powi(2);
        Vec3::new(u, v, 0.03 - 0.08 * (-r2 / 0.005).exp())
    };
    let mut cloth = Sheet::new(0.5, 0.5, 0.05).pinned(Pin::Boundary).build(1, |u, v| Vec3::new(u, v, 0.0));
    cloth.append(Sheet::new(0.3, 0.3, 0.05).build(2, dip), Vec3::new(0.103, 0.107, 0.0));
    let mut solver = Solver::new(cloth, parameters(9.81));
    for _ in 0..60 {
        solver.step(1.0 / 60.0, Help::NONE);
    }
    assert!(count_edge_face(&solver.cloth().points(), &solver.cloth().triangles).unwrap() > 0);
}

#[test]
fn help_moves_free_vertices_and_no_pinned_ones() {
    let cloth = Sheet::new(0.5, 0.5, 0.05).pinned(Pin::Boundary).build(1, |u, v| Vec3::new(u, v, 0.0));
    let middle =
        (0..cloth.positions.len()).find(|vertex| !cloth.pins.contains(&u32::try_from(*vertex).unwrap())).unwrap();
    let up = vec![Vec3::new(0.0, 0.0, 0.01); cloth.positions.len()];
    for help in [Help { displacement_m: &up, ..Help::NONE }, Help { velocity_change_m_s: &up, ..Help::NONE }] {
        let mut solver = Solver::new(cloth.clone(), parameters(0.0));
        solver.step(1.0 / 60.0, help);
        assert!(solver.cloth().positions[middle].z > 1e-5);
        for &pin in &cloth.pins {
            assert!(solver.cloth().positions[pin as usize].z.abs() < 1e-12);
        }
    }
}

#[test]
fn carried_pins_end_where_they_are_sent_and_carry_what_lies_on_them() {
    let body = Sheet::new(0.5, 0.5, 0.05).build(1, |u, v| Vec3::new(u, v, 0.0));
    let mut cloth = Cloth { pins: (0..).take(body.positions.len()).collect(), ..body };
    let num_body = cloth.positions.len();
    cloth.append(Sheet::new(0.3, 0.3, 0.05).build(2, |u, v| Vec3::new(u, v, 0.012)), Vec3::new(0.103, 0.107, 0.0));
    let mut solver = Solver::new(cloth.clone(), Parameters { friction: 0.5, ..parameters(9.81) });
    for step in 1..=30 {
        let way = Vec3::new(0.002, 0.0, 0.004) * f64::from(step);
        let places: Vec<Vec3> = cloth.positions.iter().map(|place| place + way).collect();
        solver.carry(&places);
        solver.step(1.0 / 60.0, Help::NONE);
        for (now, place) in solver.cloth().positions[..num_body].iter().zip(&places) {
            assert!((now - place).norm() < 1e-6, "step {step}: {now} instead of {place}");
        }
    }
    assert_eq!(count_edge_face(&solver.cloth().points(), &cloth.triangles).unwrap(), 0);
    let way = |k: usize| solver.cloth().positions[k] - cloth.positions[k];
    let carried = (num_body..cloth.positions.len()).map(|k| way(k).x).sum::<f64>();
    assert!(carried / (cloth.positions.len() - num_body) as f64 > 0.02, "what lies on a body goes along with it");
}
