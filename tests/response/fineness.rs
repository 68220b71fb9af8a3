//! The same tangle with finer and finer triangles comes clean in the same number of steps of a host.

use std::sync::Arc;

use nalgebra::Vector3;
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    respond::VertexFlags,
    settings::Settings,
    untangler::Untangler,
};
use untangled_checker::count_edge_face;
use untangled_publisher::{
    mesh::Cloth,
    scenes::Scene,
    solver::{Help, Parameters, Solver},
};

const DT_S: f64 = 1.0 / 60.0;
/// A state is held when it stays clean for so many steps.
const HELD: usize = 3;
const MOST_STEPS: usize = 20;

/// Steps of the example host, with forces and mask, to the first clean state that was held.
fn steps_to_clean(cloth: Cloth, settings: &Settings) -> Option<usize> {
    let parameters = Parameters::of_cloth(&cloth, 9.81);
    let mut solver = Solver::new(cloth, parameters);
    let cloth = solver.cloth();
    let mesh = Mesh::new(MeshDescription {
        num_vertices: cloth.positions.len(),
        faces: cloth.triangles.clone(),
        rest_positions: Some(cloth.rest_positions.iter().map(|&position| position.into()).collect()),
        masses_kg: Some(solver.masses_kg().to_vec()),
        pins: cloth.pins.clone(),
        ..MeshDescription::default()
    });
    let mut untangler = Untangler::new(Arc::new(mesh.unwrap()), settings.clone()).unwrap();
    let mut clean_steps = 0;
    for step in 0..=MOST_STEPS + HELD {
        let points = solver.cloth().points();
        let is_clean = count_edge_face(&points, &solver.cloth().triangles).unwrap() == 0;
        clean_steps = if is_clean { clean_steps + 1 } else { 0 };
        if clean_steps > HELD {
            return Some(step - HELD);
        }
        let frame = Frame::new(untangler.mesh(), &points).unwrap();
        let corrections = untangler.process(&frame, &mut ()).corrections;
        let steps = corrections.forces.iter().zip(solver.masses_kg()).map(|(force, mass)| force / *mass);
        let velocity_change_m_s: Vec<Vector3<f64>> = steps.map(|step| step / DT_S).collect();
        let mask = |flags: &VertexFlags| flags.contains(VertexFlags::INSIDE) || flags.contains(VertexFlags::NEAR_PATH);
        let no_contact: Vec<bool> = corrections.flags.iter().map(mask).collect();
        solver.step(DT_S, Help { velocity_change_m_s: &velocity_change_m_s, no_contact: &no_contact, ..Help::NONE });
    }
    None
}

/// Steps at edges of 0.025 m, of half and of a quarter of that.
fn steps_at_levels(name: &str, settings: &Settings) -> [Option<usize>; 3] {
    [0.025, 0.0125, 0.00625].map(|edge_m| steps_to_clean(name.parse::<Scene>().unwrap().build(1, edge_m), settings))
}

fn is_even(steps: [Option<usize>; 3]) -> bool {
    let [Some(a), Some(b), Some(c)] = steps else { return false };
    2 * a.max(b).max(c) <= 3 * a.min(b).min(c)
}

#[test]
fn forces_on_finer_meshes_take_as_many_steps() {
    for name in ["tongue", "curtains", "crease", "twist", "drop", "wedge"] {
        let steps = steps_at_levels(name, &Settings::default());
        println!("{name}: {steps:?}");
        assert!(is_even(steps), "{name}: {steps:?}");
    }
}

/// What the limit by the depth is for.
#[test]
fn forces_limited_by_edges_alone_on_finer_meshes_take_more_steps() {
    let settings = Settings { steps_to_clean: f64::INFINITY, ..Settings::default() };
    let steps = steps_at_levels("twist", &settings);
    assert!(!is_even(steps), "{steps:?}");
}
