//! Corrections of the shared scenes, of real garments and of generated scenes: finite, without residual momentum,
//! repeatable.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use nalgebra::{Point3, Vector3};
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    respond::{Corrections, VertexFlags},
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_publisher::scenes::Scene;
use untangled_testkit::files::shared;

/// Residual of a sum of vectors as a part of the sum of their lengths.
fn residual(sum: Vector3<f64>, lengths: f64) -> f64 {
    if lengths > 0.0 { sum.norm() / lengths } else { 0.0 }
}

/// Net force and net torque as parts of the sums of the magnitudes of all forces and torques, and the sum of all
/// forces.
fn residuals(frame: &Frame, corrections: &Corrections) -> ([f64; 2], f64) {
    let centre = centre(frame);
    let moments = frame.positions().iter().zip(&corrections.forces);
    let moments: f64 = moments.map(|(position, force)| (position - centre).norm() * force.norm()).sum();
    let forces: f64 = corrections.forces.iter().map(Vector3::norm).sum();
    ([residual(corrections.net_force, forces), residual(corrections.net_torque, moments)], forces)
}

fn centre(frame: &Frame) -> Point3<f64> {
    let sum: Vector3<f64> = frame.positions().iter().map(|position| position.coords).sum();
    Point3::from(sum / frame.positions().len() as f64)
}

/// Checks the corrections of one file by each response; returns how often there was something to correct.
fn check_file(file: &Path) -> usize {
    let name = file.file_name().unwrap().to_string_lossy();
    let Ok(read) = read_mesh(file) else { return 0 };
    let world = concatenate(&[read]).unwrap();
    let mesh = Arc::new(Mesh::new(world.description).unwrap());
    let Ok(frame) = Frame::new(&mesh, &world.positions) else { return 0 };
    let mut corrected = 0;
    for response in [Response::Rbf, Response::Contour, Response::Displacement] {
        let settings = Settings { response, ..Settings::default() };
        let mut untangler = Untangler::new(mesh.clone(), settings).unwrap();
        let outcome = untangler.process(&frame, &mut ());
        let is_clean = outcome.analysis.intersections.segments.is_empty();
        let corrections = outcome.corrections.clone();
        assert!(corrections.forces.iter().flatten().all(|value| value.is_finite()), "{name}, {response:?}");
        // Degenerate contacts may have no length, and then no direction. A displacement stands still where each that
        // was tried does harm: then there is no mask either.
        let is_still = corrections.forces.iter().all(|force| *force == Vector3::zeros());
        let may_stand_still = name.starts_with("deg_")
            || response == Response::Displacement
                && corrections.flags.iter().all(|flags| *flags == VertexFlags::default());
        assert!(if is_clean { is_still } else { !is_still || may_stand_still }, "{name}, {response:?}");
        let again = untangler.process(&frame, &mut ()).corrections;
        assert_eq!(corrections.forces, again.forces, "{name}, {response:?}");
        assert_eq!(corrections.flags, again.flags, "{name}, {response:?}");
        // Away from the origin positions themselves are rounded by more.
        let centre = centre(&frame);
        let far = frame.positions().iter().map(|position| position.coords.norm()).fold(0.0, f64::max);
        let size = frame.positions().iter().map(|position| (position - centre).norm()).fold(0.0, f64::max);
        let bound = 1e-10 * (far / size).max(1.0);
        let (left, _) = residuals(&frame, &corrections);
        assert!(
            response == Response::Displacement || left.iter().all(|&left| left < bound),
            "{name}, {response:?}: {left:?}"
        );
        corrected += usize::from(!is_clean);
    }
    corrected
}

#[test]
fn corrections_of_shared_files_are_finite_and_keep_momenta() {
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["scenes", "scenes/units", "data"] {
        let Some(folder) = shared(folder) else { return };
        files.extend(fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    assert!(files.iter().map(|file| check_file(file)).sum::<usize>() > 0);
}

/// Frames of all types of paths, and what a few steps along the forces make of them.
#[test]
fn corrections_of_generated_scenes_keep_momenta() {
    let (mut worst, mut frames) = ([0.0f64; 2], 0);
    for name in ["bag", "tongue", "curtains", "crease", "twist", "drop", "wedge"] {
        for seed in 1..=3 {
            let cloth = name.parse::<Scene>().unwrap().build(seed, 0.04);
            let mesh = Mesh::new(MeshDescription {
                num_vertices: cloth.positions.len(),
                faces: cloth.triangles.clone(),
                rest_positions: Some(cloth.rest_positions.iter().map(|&position| position.into()).collect()),
                masses_kg: Some(cloth.masses_kg(0.2)),
                ..MeshDescription::default()
            });
            let mesh = Arc::new(mesh.unwrap());
            for response in [Response::Rbf, Response::Contour] {
                let settings = Settings { response, ..Settings::default() };
                let mut untangler = Untangler::new(mesh.clone(), settings).unwrap();
                let mut positions = cloth.points();
                for _ in 0..4 {
                    let frame = Frame::new(&mesh, &positions).unwrap();
                    let corrections = untangler.process(&frame, &mut ()).corrections;
                    let (left, forces) = residuals(&frame, corrections);
                    worst = [worst[0].max(left[0]), worst[1].max(left[1])];
                    frames += usize::from(forces > 0.0);
                    let moves = corrections.forces.iter().zip(mesh.masses_kg().unwrap());
                    for (position, (force, mass)) in positions.iter_mut().zip(moves) {
                        *position = (Vector3::from(*position) + force / *mass).into();
                    }
                }
            }
        }
    }
    println!("{frames} frames: {:.1e} of the forces, {:.1e} of the torques left", worst[0], worst[1]);
    assert!(frames > 80 && worst.iter().all(|&left| left < 1e-10), "{worst:?} over {frames} frames");
}
