//! Other ways to the same pairs of faces: parry's tree over the same boxes, where testing all pairs takes too long, and
//! all pairs, where single precision decides little.

use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{
    analysis::analyse,
    frame::Frame,
    intersect::do_intersect,
    mesh::{EdgeId, FaceId, Mesh, MeshDescription},
    predicates::{Site, side_of_plane},
};
use untangled_testkit::generate::{crumpled, squares};

/// Whether an edge pierces a face that it shares no vertex with, from the definition.
fn pierces(mesh: &Mesh, frame: &Frame, edge: EdgeId, face: FaceId) -> bool {
    if mesh.edge(edge).iter().any(|end| mesh.face(face).contains(end)) {
        return false;
    }
    let site = |vertex| Site { position: frame.position(vertex).coords.into(), index: vertex.0 };
    let ([p, q], [a, b, c]) = (mesh.edge(edge).map(site), mesh.face(face).map(site));
    let signs = [(a, b), (b, c), (c, a)].map(|(from, to)| side_of_plane(p, q, from, to));
    side_of_plane(a, b, c, p) != side_of_plane(a, b, c, q) && signs[0] == signs[1] && signs[1] == signs[2]
}

#[test]
fn intersections_of_a_large_crumpled_sheet_equal_those_by_parrys_tree() {
    check(125);
}

/// Some minutes and gigabytes: `cargo test --release --test analysis -- --ignored two_million`.
#[test]
#[ignore = "two million triangles"]
fn intersections_of_two_million_triangles_equal_those_by_parrys_tree() {
    check(1000);
}

fn check(resolution: u32) {
    let sheet = crumpled(11, resolution);
    let mesh = sheet.mesh();
    let frame = sheet.frame(&mesh);
    let boxes: Vec<Aabb> = mesh
        .face_ids()
        .map(|face| {
            let corners = mesh.face(face).map(|vertex| frame.position(vertex));
            Aabb::from_points(corners.map(|corner| Vector::new(corner.x, corner.y, corner.z)))
        })
        .collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let mut expected = Vec::new();
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |a, b| {
        for (owner, face) in [(FaceId(a), FaceId(b)), (FaceId(b), FaceId(a))] {
            let edges = mesh.face_edges(owner).unwrap();
            expected.extend(
                edges.map(|edge| (edge, face)).into_iter().filter(|&(edge, face)| pierces(&mesh, &frame, edge, face)),
            );
        }
    });
    expected.sort_unstable();
    expected.dedup();
    let found: Vec<(EdgeId, FaceId)> =
        analyse(&mesh, &frame).intersections.edge_face.iter().map(|hit| (hit.edge, hit.face)).collect();
    assert!(found.len() > 500);
    assert_eq!(found, expected);
}

/// Two sheets that nearly touch or cross by a hair, and a triangle so far away that all of them is little.
#[test]
fn intersections_beside_a_far_triangle_equal_those_of_all_pairs() {
    const RESOLUTION: u32 = 7;
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (faces, uvs) = squares(RESOLUTION, &mut rng);
    let count = u32::try_from(uvs.len()).unwrap();
    let mut both = faces.clone();
    both.extend(faces.iter().map(|corners| corners.map(|corner| corner + count)));
    both.push([2 * count, 2 * count + 1, 2 * count + 2]);
    let mesh =
        Mesh::new(MeshDescription { num_vertices: 2 * uvs.len() + 3, faces: both, ..MeshDescription::default() })
            .unwrap();
    let mut num_found = 0;
    for round in 0..120 {
        let [away, gap, noise] = [0.0..9.0, -12.0..-1.0, -12.0..-0.5].map(|range| 10f64.powf(rng.random_range(range)));
        let mut positions: Vec<[f64; 3]> = Vec::new();
        for layer in [0.0, gap] {
            for &[u, v] in &uvs {
                let mut off = || noise * rng.random_range(-1.0..1.0) / f64::from(RESOLUTION);
                positions.push([u + off(), v + off(), 0.3 * (4.0 * u + v).sin() + layer + off()]);
            }
        }
        positions.extend([[away, 0.0, 0.0], [away, 0.1, 0.0], [away, 0.0, 0.1]]);
        let frame = Frame::new(&mesh, &positions).unwrap();
        let segments = analyse(&mesh, &frame).intersections.segments;
        let found: Vec<[FaceId; 2]> = segments.iter().map(|segment| segment.faces).collect();
        let all: Vec<FaceId> = mesh.face_ids().collect();
        let pairs = all.iter().flat_map(|&a| all[a.index() + 1..].iter().map(move |&b| [a, b]));
        let expected: Vec<[FaceId; 2]> = pairs.filter(|&pair| do_intersect(&mesh, &frame, pair)).collect();
        assert_eq!(found, expected, "round {round}: {away:e} away, {gap:e} apart, {noise:e} rough");
        num_found += found.len();
    }
    assert!(num_found > 1_000, "{num_found}");
}
