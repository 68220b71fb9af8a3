//! A warm untangler takes no memory: the second time that the same frames come, nothing is allocated.
//!
//! Counted on the one thread of a pool, since the trees of the broad phase are built in parallel.
#![cfg(feature = "daemon")]
#![allow(clippy::unwrap_used, reason = "a test")]

use std::sync::Arc;

use untangle::{analysis::Analyser, frame::Frame, mesh::{Mesh, MeshDescription, Uvs}, respond::Responder, settings::{Response, Settings}};
use untangled_publisher::{mesh::Cloth, scenes::Scene};

/// Scenes of all types, as the mesh tells more or less about its shape.
fn meshes(cloth: &Cloth) -> Vec<Mesh> {
    let uvs = cloth.uvs.as_ref().map(|uvs| Uvs { coordinates: uvs.coordinates.clone(), corners: uvs.corners.clone() });
    let rest = cloth.rest_positions.iter().map(|&position| position.into()).collect();
    let description = |uvs, rest_positions| MeshDescription {
        num_vertices: cloth.positions.len(),
        faces: cloth.triangles.clone(),
        pins: cloth.pins.clone(),
        uvs,
        rest_positions,
        ..MeshDescription::default()
    };
    [description(uvs, None), description(None, Some(rest)), description(None, None)]
        .into_iter()
        .map(|description| Mesh::new(description).unwrap())
        .collect()
}

#[test]
fn a_warm_frame_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut worst = [0, 0];
    for name in ["gallery", "curtains"] {
        let cloth = name.parse::<Scene>().unwrap().build(1, 0.03);
        // So far that all is searched from nothing, and so little that proofs are kept.
        let later = [0.002, 0.0001].map(|amplitude| {
            let mut later = cloth.points();
            for (index, position) in later.iter_mut().enumerate() {
                let index = f64::from(u32::try_from(index).unwrap());
                position[2] += amplitude * (0.7 * index).sin();
            }
            later
        });
        let all =
            meshes(&cloth).into_iter().map(Arc::new).flat_map(|mesh| [(mesh.clone(), &later[0]), (mesh, &later[1])]);
        for (mesh, later) in all {
            let frames = [cloth.points(), later.clone()].map(|positions| Frame::new(&mesh, &positions).unwrap());
            for response in [Response::Rbf, Response::Contour, Response::Displacement, Response::Mask] {
                let settings = Settings { response, ..Settings::default() };
                let counts = pool.install(|| {
                    let (mut analyser, mut responder) = (Analyser::default(), Responder::default());
                    let mut counts = [0, 0];
                    for round in 0..3 {
                        for frame in &frames {
                            let mut analysis = None;
                            let first = allocation_counter::measure(|| {
                                analysis = Some(analyser.analyse(&mesh, frame, &settings, &mut ()));
                            });
                            let analysis = analysis.unwrap();
                            assert!(analysis.paths.pairs.len() > usize::from(name == "gallery") * 5);
                            let second = allocation_counter::measure(|| {
                                responder.respond(&mesh, frame, analysis, &settings, &mut ());
                            });
                            if round > 0 {
                                counts[0] += first.count_total;
                                counts[1] += second.count_total;
                            }
                        }
                    }
                    counts
                });
                println!("{name}, {response:?}: {counts:?} allocations in analysis and response");
                worst = [worst[0].max(counts[0]), worst[1].max(counts[1])];
            }
        }
    }
    assert_eq!(worst, [0, 0], "allocations of warm frames in analysis and in response");
}
