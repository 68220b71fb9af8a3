use nalgebra::Vector3;

use super::{Motion, MotionFinder, Scene, Shadow, contours, remaining_depth_m};
use crate::{analysis::analyse, frame::Frame, mesh::Mesh, relax::escape::tests::samples::Pieces, sides::Orientation};

/// The motions of all contours of a scene.
fn motions(mesh: &Mesh, frame: &Frame) -> Vec<Motion> {
    let analysis = analyse(mesh, frame);
    let orientation = &Orientation::of(mesh);
    let scene = Scene { mesh, frame, orientation, found: &analysis.intersections };
    let mut found = Vec::new();
    for contour in contours(mesh, frame, &analysis.paths) {
        MotionFinder::of_variant(0).find(&scene, &contour, &mut found);
    }
    found
}

#[test]
fn motion_of_tongue_through_sheet_is_along_it_and_as_long_as_it_sticks_out_at_any_resolution() {
    for squares in [8, 16] {
        let (mesh, frame) = Pieces::tongue(squares, 0.31).mesh();
        let found = motions(&mesh, &frame);
        assert_eq!(found.len(), 1, "{squares}");
        let along = found[0].direction.dot(&Vector3::z()).abs();
        assert!(along > 0.9, "{squares} {along}");
        assert!((found[0].depth_m - 0.31).abs() < 0.05, "{squares} {}", found[0].depth_m);
    }
}

#[test]
fn remaining_depth_after_the_motion_is_none() {
    let (mesh, frame) = Pieces::tongue(8, 0.31).mesh();
    let motion = &motions(&mesh, &frame)[0];
    assert!((remaining_depth_m(&mut Shadow::default(), &mesh, &frame, motion) - motion.depth_m).abs() < 1e-12);
    let first = mesh.piece(motion.first);
    let mut positions: Vec<[f64; 3]> = frame.positions().iter().map(|point| (*point).into()).collect();
    for face in mesh.face_ids().filter(|&face| mesh.piece(face) == first) {
        for vertex in mesh.face(face) {
            positions[vertex.index()] = (frame.position(vertex) + motion.direction * (1.01 * motion.depth_m)).into();
        }
    }
    let moved = Frame::new(&mesh, &positions).unwrap();
    assert!(analyse(&mesh, &moved).intersections.edge_face.is_empty());
    assert!(remaining_depth_m(&mut Shadow::default(), &mesh, &moved, motion) < 1e-12);
}
