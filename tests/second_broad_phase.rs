//! A broad phase of somebody else's as the oracle, where testing all pairs takes too long: parry's tree over the same boxes.

#![allow(clippy::unwrap_used, reason = "a test")]

#[path = "support/sheet.rs"]
#[allow(dead_code, reason = "a part of it")]
mod sheet;

use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace},
};
use untangled::{
    analysis::analyse,
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh},
    predicates::{Site, side_of_plane},
};

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
fn a_large_crumpled_sheet_has_the_same_intersections_by_another_tree() {
    check(125);
}

/// Some minutes and gigabytes: `cargo test --release --test second_broad_phase -- --ignored`.
#[test]
#[ignore = "two million triangles"]
fn two_million_triangles_have_the_same_intersections_by_another_tree() {
    check(1000);
}

fn check(resolution: u32) {
    let crumpled = sheet::crumpled(11, resolution);
    let mesh = crumpled.mesh();
    let frame = crumpled.frame(&mesh);
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
