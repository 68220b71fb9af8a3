//! Corrections of the shared scenes and of real garments: finite, without residual momentum, the same every time.
//!
//! The files lie in `../shared`, which is not part of this repository; where it is missing, this test says so and passes.

use std::{fs, path::Path, sync::Arc};

use nalgebra::{Point3, Vector3};
use untangle::{frame::Frame, mesh::Mesh, settings::{Response, Settings}, untangler::Untangler};
use untangled_mesh_io::{concatenate, read_mesh};

/// Residual of a sum of vectors as a part of the sum of their lengths.
fn residual(sum: Vector3<f64>, lengths: f64) -> f64 {
    if lengths > 0.0 { sum.norm() / lengths } else { 0.0 }
}

#[test]
fn corrections_of_all_shared_files_keep_momenta_and_are_finite() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    if !shared.is_dir() {
        println!("skipped: {} is not there", shared.display());
        return;
    }
    let mut files = Vec::new();
    for folder in ["scenes", "scenes/units", "data"] {
        files.extend(fs::read_dir(shared.join(folder)).unwrap().map(|entry| entry.unwrap().path()));
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    let mut corrected = 0;
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(file) = read_mesh(&file) else { continue };
        let world = concatenate(&[file]).unwrap();
        let mesh = Arc::new(Mesh::new(world.description).unwrap());
        let Ok(frame) = Frame::new(&mesh, &world.positions) else { continue };
        for response in [Response::Rbf, Response::Contour, Response::Displacement] {
            let settings = Settings { response, ..Settings::default() };
            let mut untangler = Untangler::new(mesh.clone(), settings).unwrap();
            let outcome = untangler.process(&frame, &mut ());
            let is_clean = outcome.analysis.intersections.segments.is_empty();
            let corrections = outcome.corrections.clone();
            assert!(corrections.forces.iter().flatten().all(|value| value.is_finite()), "{name}, {response:?}");
            // Degenerate contacts may have no length, and then no direction.
            let is_still = corrections.forces.iter().all(|force| *force == Vector3::zeros());
            assert!(is_still == is_clean || name.starts_with("deg_"), "{name}, {response:?}");
            let again = untangler.process(&frame, &mut ()).corrections;
            assert_eq!(corrections.forces, again.forces, "{name}, {response:?}");
            assert_eq!(corrections.flags, again.flags, "{name}, {response:?}");

            let forces: f64 = corrections.forces.iter().map(Vector3::norm).sum();
            let centre = centre(&frame);
            let moments = frame.positions().iter().zip(&corrections.forces);
            let moments: f64 = moments.map(|(position, force)| (position - centre).norm() * force.norm()).sum();
            // Away from the origin positions themselves are rounded by more.
            let far = frame.positions().iter().map(|position| position.coords.norm()).fold(0.0, f64::max);
            let size = frame.positions().iter().map(|position| (position - centre).norm()).fold(0.0, f64::max);
            let bound = 1e-10 * (far / size).max(1.0);
            if response != Response::Displacement {
                assert!(residual(corrections.net_force, forces) < bound, "{name}, {response:?}");
                assert!(residual(corrections.net_torque, moments) < bound, "{name}, {response:?}");
            }
            corrected += usize::from(!is_clean);
        }
    }
    assert!(corrected > 0);
}

/// Frames of all types of paths, and what a few steps along the forces make of them.
#[cfg(feature = "daemon")]
#[test]
fn corrections_of_generated_scenes_keep_momenta() {
    use untangle::mesh::MeshDescription;
    use untangled_publisher::scenes::Scene;

    let (mut worst, mut frames) = ([0.0f64; 2], 0);
    for (name, seed) in ["bag", "tongue", "curtains", "crease", "twist", "drop", "wedge"]
        .into_iter()
        .flat_map(|name| (1..=3).map(move |seed| (name, seed)))
    {
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
                let centre = centre(&frame);
                let moments = frame.positions().iter().zip(&corrections.forces);
                let moments: f64 = moments.map(|(position, force)| (position - centre).norm() * force.norm()).sum();
                let forces: f64 = corrections.forces.iter().map(Vector3::norm).sum();
                worst[0] = worst[0].max(residual(corrections.net_force, forces));
                worst[1] = worst[1].max(residual(corrections.net_torque, moments));
                frames += usize::from(forces > 0.0);
                for ((position, force), mass) in
                    positions.iter_mut().zip(&corrections.forces).zip(mesh.masses_kg().unwrap())
                {
                    *position = (Vector3::from(*position) + force / *mass).into();
                }
            }
        }
    }
    println!("{frames} frames: {:.1e} of the forces, {:.1e} of the torques left", worst[0], worst[1]);
    assert!(frames > 80 && worst.iter().all(|&left| left < 1e-10), "{worst:?} over {frames} frames");
}

fn centre(frame: &Frame) -> Point3<f64> {
    let sum: Vector3<f64> = frame.positions().iter().map(|position| position.coords).sum();
    Point3::from(sum / frame.positions().len() as f64)
}
