//! The search with bodies: pairs of two faces of bodies are left out, and no others.

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription, VertexId},
};
use untangled_testkit::{
    generate::{Sheet, crumpled, fan},
    judge::brute_force,
};

/// Crumpled sheets and a fan round a vertex of many faces, as one mesh; those asked for are bodies.
fn scene(seed: u64, is_body: [bool; 3]) -> (Mesh, Vec<[f64; 3]>) {
    let sheets = [crumpled(seed, 9), crumpled(seed + 1000, 13), fan(5, 80)];
    let (mut positions, mut faces, mut body) = (Vec::new(), Vec::new(), Vec::new());
    for (Sheet { positions: own, faces: triangles, .. }, is_body) in sheets.into_iter().zip(is_body) {
        let offset = u32::try_from(positions.len()).unwrap();
        positions.extend(own);
        faces.extend(triangles.into_iter().map(|face| face.map(|corner| corner + offset)));
        if is_body {
            body.extend(offset..u32::try_from(positions.len()).unwrap());
        }
    }
    let description = MeshDescription { num_vertices: positions.len(), faces, body, ..Default::default() };
    (Mesh::new(description).unwrap(), positions)
}

#[test]
fn search_with_bodies_equals_brute_force_without_pairs_of_their_faces() {
    let mut counts = [0; 2];
    for (seed, is_body) in (0..10).zip(
        [[true, false, false], [false, true, false], [false, true, true], [true, false, true], [false, false, true]]
            .into_iter()
            .cycle(),
    ) {
        let (mesh, positions) = scene(seed, is_body);
        // Steps so small that the later searches look only where certificates have expired.
        let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
        let mut frame = Frame::default();
        // Bodies move, stay, and move again.
        for (step, step_of_bodies) in (0..).zip([0, 1, 1, 1, 2]) {
            let moved = (0..).zip(&positions).map(|(vertex, &[x, y, z])| {
                let is_body = mesh.is_body(VertexId(vertex));
                let shift = 1e-4 * f64::from(if is_body { step_of_bodies } else { step });
                [x + shift * y, y, z - shift * x]
            });
            let moved: Vec<[f64; 3]> = moved.collect();
            frame.set(&mesh, moved.iter().copied()).unwrap();
            intersector.intersect(&mesh, &frame, &mut found);
            let is_body_edge = |edge| mesh.is_body(mesh.edge(edge)[0]);
            let all = brute_force::edge_face_intersections(&mesh, &frame);
            let num_all = all.len();
            let expected: Vec<_> =
                all.into_iter().filter(|&(edge, face)| !(is_body_edge(edge) && mesh.is_body_face(face))).collect();
            let own: Vec<_> = found.edge_face.iter().map(|found| (found.edge, found.face)).collect();
            assert_eq!(own, expected, "seed {seed}, step {step}");
            counts[0] += expected.len();
            counts[1] += num_all - expected.len();
        }
    }
    assert!(counts.iter().all(|&count| count > 1000), "{counts:?}");
}

#[test]
fn search_after_frames_whose_bodies_stayed_equals_the_first_search_of_a_frame() {
    // So large that most blocks of vertices and nodes of the tree hold nothing but a body.
    let (body, cloth) = (crumpled(3, 60), crumpled(4, 30));
    let num_body = u32::try_from(body.positions.len()).unwrap();
    let faces = body.faces.into_iter().chain(cloth.faces.iter().map(|face| face.map(|corner| corner + num_body)));
    let positions: Vec<[f64; 3]> = body.positions.into_iter().chain(cloth.positions).collect();
    let description = MeshDescription { num_vertices: positions.len(), faces: faces.collect(), ..Default::default() };
    let mesh = Mesh::new(MeshDescription { body: (0..num_body).collect(), ..description }).unwrap();
    // Steps at which all is searched again, and such that certificates last.
    for size in [0.01, 1e-5] {
        let (mut intersector, mut frame) = (Intersector::default(), Frame::default());
        let mut counts = Vec::new();
        for (step, step_of_body) in (0..).zip([0, 0, 0, 1, 1, 2, 2, 2]) {
            let moved = (0..).zip(&positions).map(|(vertex, &[x, y, z])| {
                let shift = size * f64::from(if vertex < num_body { step_of_body } else { step });
                [x + shift * y, y, z - shift * x]
            });
            let moved: Vec<[f64; 3]> = moved.collect();
            frame.set(&mesh, moved.iter().copied()).unwrap();
            let [mut found, mut expected] = [(); 2].map(|()| Intersections::default());
            intersector.intersect(&mesh, &frame, &mut found);
            Intersector::default().intersect(&mesh, &Frame::new(&mesh, &moved).unwrap(), &mut expected);
            assert_eq!(found.edge_face, expected.edge_face, "steps of {size}, step {step}");
            assert_eq!(found.segments, expected.segments, "steps of {size}, step {step}");
            counts.push(found.edge_face.len());
        }
        assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
        counts.dedup();
        assert!(size < 0.01 || counts.len() > 4, "{counts:?}");
    }
}
