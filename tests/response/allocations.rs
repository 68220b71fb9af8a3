//! Frames after warm-up allocate nothing.
//!
//! Counted on the one thread of a pool, since the bounding volume hierarchies are built in parallel.

use std::sync::Arc;

use untangle::{
    analysis::Analyser,
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    respond::Responder,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_publisher::{mesh::Cloth, scenes::Scene};

/// Scenes of all types, as the mesh tells more or less about its shape.
pub(crate) fn meshes(cloth: &Cloth) -> Vec<Mesh> {
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

/// Allocations of analysis and of response in the second and third round of some frames.
fn warm_allocations(mesh: &Mesh, frames: &[Frame], response: Response, min_pairs: usize) -> [u64; 2] {
    let settings = Settings { response, ..Settings::default() };
    let (mut analyser, mut responder) = (Analyser::default(), Responder::default());
    responder.set_labelled(true);
    let mut counts = [0, 0];
    for round in 0..3 {
        for frame in frames {
            let mut analysis = None;
            let first = allocation_counter::measure(|| {
                analysis = Some(analyser.analyse(mesh, frame, &settings, &mut ()));
            });
            let analysis = analysis.unwrap();
            assert!(analysis.paths.pairs.len() > min_pairs);
            let second = allocation_counter::measure(|| {
                responder.respond(mesh, frame, analysis, &settings, &mut ());
            });
            if round > 0 {
                counts[0] += first.count_total;
                counts[1] += second.count_total;
            }
        }
    }
    counts
}

#[test]
fn analyser_and_responder_on_warm_frames_allocate_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut worst = [0, 0];
    for (name, min_pairs) in [("gallery", 5), ("curtains", 0)] {
        let cloth = name.parse::<Scene>().unwrap().build(1, 0.03);
        // So far that certificates expire, and so little that they hold.
        let later = [0.002, 0.0001].map(|amplitude| {
            let mut later = cloth.points();
            for (index, position) in later.iter_mut().enumerate() {
                let index = f64::from(u32::try_from(index).unwrap());
                position[2] += amplitude * (0.7 * index).sin();
            }
            later
        });
        for (mesh, later) in meshes(&cloth).iter().flat_map(|mesh| later.each_ref().map(|later| (mesh, later))) {
            let frames = [cloth.points(), later.clone()].map(|positions| Frame::new(mesh, &positions).unwrap());
            for response in [Response::Rbf, Response::Contour, Response::Displacement, Response::Mask] {
                let counts = pool.install(|| warm_allocations(mesh, &frames, response, min_pairs));
                println!("{name}, {response:?}: {counts:?} allocations in analysis and response");
                worst = [worst[0].max(counts[0]), worst[1].max(counts[1])];
            }
        }
    }
    assert_eq!(worst, [0, 0], "allocations of warm frames in analysis and in response");
}

/// Tangles whose displacements are judged, and shortened in some of them; with a gap that is kept beside them.
#[test]
fn untangler_on_warm_frames_of_judged_displacements_and_of_a_gap_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let cases = [
        (Response::Displacement, None),
        (Response::Displacement, Some(0.01)),
        (Response::Rbf, Some(0.01)),
        (Response::Contour, Some(0.01)),
    ];
    for (name, (response, thickness_m)) in
        ["gallery", "curtains", "tongue", "twist"].into_iter().flat_map(|name| cases.map(|case| (name, case)))
    {
        let settings = Settings { response, thickness_m, ..Settings::default() };
        let cloth = name.parse::<Scene>().unwrap().build(1, 0.03);
        let mesh = Arc::new(meshes(&cloth).swap_remove(1));
        let frame = Frame::new(&mesh, &cloth.points()).unwrap();
        let mut untangler = Untangler::new(Arc::clone(&mesh), settings).unwrap();
        let counts = pool.install(|| {
            // The second is the first that is searched by certificates.
            [0, 1, 2, 3].map(|_| {
                let count = allocation_counter::measure(|| {
                    untangler.process(&frame, &mut ());
                });
                count.count_total
            })
        });
        println!("{name}, {response:?}, {thickness_m:?}: {counts:?} allocations in a frame");
        assert!(counts[0] > 0 && counts[2..] == [0, 0], "{name}, {response:?}, {thickness_m:?}: {counts:?}");
    }
}
