//! Sides of generated bodies.

use nalgebra::{Point3, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Layers, Sides, solid_angle::part_of_sphere, winding::WindingTree};
use crate::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
};

/// Balls of a radius of 1 m, each of `2 rings^2` or so faces.
pub(super) fn balls(centres: &[[f64; 3]], rings: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let around = 2 * rings;
    for centre in centres {
        let first = u32::try_from(positions.len()).unwrap();
        let mut add = |at: Vector3<f64>| positions.push([0, 1, 2].map(|axis| centre[axis] + at[axis]));
        add(Vector3::z());
        for ring in 1..rings {
            for step in 0..around {
                let (lat, long) = [(ring, rings), (step, rings)]
                    .map(|(a, b)| f64::from(a) / f64::from(b) * std::f64::consts::PI)
                    .into();
                add(Vector3::new(lat.sin() * long.cos(), lat.sin() * long.sin(), lat.cos()));
            }
        }
        add(-Vector3::z());
        let last = first + 1 + around * (rings - 1);
        let at = |ring: u32, step: u32| first + 1 + (ring - 1) * around + step % around;
        for step in 0..around {
            faces.push([first, at(1, step), at(1, step + 1)]);
            faces.push([last, at(rings - 1, step + 1), at(rings - 1, step)]);
            for ring in 1..rings - 1 {
                faces.push([at(ring, step), at(ring + 1, step), at(ring + 1, step + 1)]);
                faces.push([at(ring, step), at(ring + 1, step + 1), at(ring, step + 1)]);
            }
        }
    }
    (positions, faces)
}

fn sides_of(positions: &[[f64; 3]], faces: Vec<[u32; 3]>) -> Sides {
    let num_vertices = positions.len();
    let body = (0..u32::try_from(num_vertices).unwrap()).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices, faces, body, ..Default::default() }).unwrap();
    Sides::of(&mesh, &Frame::new(&mesh, positions).unwrap()).unwrap()
}

fn random_point(random: &mut impl Rng, size: f64) -> Point3<f64> {
    Point3::from(Vector3::from_fn(|_, _| random.random_range(-size..size)))
}

#[test]
fn winding_number_of_tree_is_that_of_the_sum_over_all_faces() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (positions, faces) = balls(&[[0.0; 3], [0.9, 0.2, 0.1]], 24);
    // A third of the faces is missing, so that the number is no integer.
    for keep in [1, 3] {
        let triangles: Vec<[Point3<f64>; 3]> = faces
            .iter()
            .enumerate()
            .filter(|(index, _)| keep == 1 || index % keep != 0)
            .map(|(_, face)| face.map(|corner| positions[corner as usize].into()))
            .collect();
        let tree = WindingTree::new(&triangles);
        for _ in 0..400 {
            let at = random_point(&mut random, 2.0);
            let sum: f64 = triangles.iter().map(|triangle| part_of_sphere(triangle, at)).sum();
            let found = tree.number(at);
            assert!((found - sum).abs() < 0.03, "{found} {sum} at {at}");
            assert_eq!(found > 0.5, sum > 0.5, "{found} {sum} at {at}");
        }
    }
}

#[test]
fn inside_of_overlapping_balls_is_inside_of_one_of_them_however_faces_point() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let centres = [[0.0; 3], [1.2, 0.0, 0.0], [0.6, 0.9, 0.0]];
    let (positions, faces) = balls(&centres, 16);
    let mut turned = faces.clone();
    for face in &mut turned[..faces.len() / 3] {
        face.swap(1, 2);
    }
    for faces in [faces, turned] {
        let sides = sides_of(&positions, faces);
        assert!(sides.are_closed());
        for _ in 0..2000 {
            let at = random_point(&mut random, 2.5);
            let distance = |centre: &[f64; 3]| (at - Point3::from(*centre)).norm();
            let nearest = centres.iter().map(distance).fold(f64::INFINITY, f64::min);
            // The balls are polyhedra.
            if !(0.98..=1.0).contains(&nearest) {
                assert_eq!(sides.is_inside(at), nearest < 0.98, "{at}");
            }
        }
    }
}

#[test]
fn way_out_of_overlapping_balls_leads_to_the_closest_point_of_their_hull() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let centres = [[0.0; 3], [1.2, 0.0, 0.0]];
    let (positions, faces) = balls(&centres, 24);
    let sides = sides_of(&positions, faces);
    let mut num_overlapping = 0;
    for _ in 0..2000 {
        let at = random_point(&mut random, 1.2);
        if !sides.is_inside(at) {
            continue;
        }
        let depths = centres.map(|centre| 1.0 - (at - Point3::from(centre)).norm());
        let way = sides.way_out(at);
        let end = at + way.direction * way.depth_m;
        assert!(!sides.is_inside(end + way.direction * 1e-6), "{at}");
        // Never shorter than out of the one ball in which it is deepest; the circle in which they meet may be farther.
        let deepest = depths[0].max(depths[1]);
        assert!(way.depth_m > deepest - 0.02, "{at}: {} {depths:?}", way.depth_m);
        if at.x < 0.0 {
            assert!(way.depth_m < depths[0] + 0.01, "{at}: {} {depths:?}", way.depth_m);
        }
        num_overlapping += usize::from(depths[0] > 0.0 && depths[1] > 0.0);
    }
    assert!(num_overlapping > 100);
}

#[test]
fn wrong_vertices_are_those_of_cloth_inside_and_no_vertex_of_the_body() {
    let (mut positions, mut faces) = balls(&[[0.0; 3], [0.5, 0.0, 0.0]], 12);
    let num_body = u32::try_from(positions.len()).unwrap();
    positions.extend([[0.0, 0.0, 0.5], [0.1, 0.0, 2.0], [0.3, 0.4, 0.1], [9.0, 0.0, 0.0]]);
    faces.extend([[num_body, num_body + 1, num_body + 2], [num_body + 1, num_body + 2, num_body + 3]]);
    let num_vertices = positions.len();
    let body = (0..num_body).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices, faces, body, ..Default::default() }).unwrap();
    let frame = Frame::new(&mesh, &positions).unwrap();
    let wrong = Sides::of(&mesh, &frame).unwrap().wrong_vertices(&mesh, &frame);
    let vertices: Vec<u32> = wrong.iter().map(|wrong| wrong.vertex.0).collect();
    assert_eq!(vertices, [num_body, num_body + 2]);
    assert!((wrong[0].way.depth_m - 0.5).abs() < 0.05, "{wrong:?}");
}

/// An open tube round the third axis, of two faces for each of `around x around` squares.
fn tube(radius: f64, [low, high]: [f64; 2], around: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let angle = |step: u32| std::f64::consts::TAU * f64::from(step) / f64::from(around);
    let height = |row: u32| low + (high - low) * f64::from(row) / f64::from(around);
    let rows = (0..=around).flat_map(|row| (0..around).map(move |step| (row, step)));
    let positions =
        rows.map(|(row, step)| [radius * angle(step).cos(), radius * angle(step).sin(), height(row)]).collect();
    let squares = (0..around).flat_map(|row| (0..around).map(move |step| (row, step)));
    let faces = squares.flat_map(|(row, step)| {
        let at = |row: u32, step: u32| row * around + step % around;
        let [a, b, c, d] = [at(row, step), at(row, step + 1), at(row + 1, step + 1), at(row + 1, step)];
        [[a, b, c], [a, c, d]]
    });
    (positions, faces.collect())
}

#[test]
fn behind_an_inner_layer_are_vertices_within_it_and_none_beyond_its_hems_however_faces_point() {
    // The second layer begins below the first one, and ends within it.
    let (inner, inner_faces) = tube(1.0, [-2.0, 2.0], 24);
    for (radius, expected) in [(0.9, true), (1.1, false)] {
        let (outer, outer_faces) = tube(radius, [-3.0, 1.0], 20);
        for turned in [[false, false], [true, false], [false, true], [true, true]] {
            let turn = |face: [u32; 3], is_turned: bool| if is_turned { [face[0], face[2], face[1]] } else { face };
            let first = u32::try_from(inner.len()).unwrap();
            let of_outer = outer_faces.iter().map(|face| turn(face.map(|corner| corner + first), turned[1]));
            let faces = inner_faces.iter().map(|&face| turn(face, turned[0])).chain(of_outer).collect();
            let positions = [inner.clone(), outer.clone()].concat();
            let layers = (0..positions.len()).map(|vertex| u32::from(vertex >= inner.len())).collect();
            let num_vertices = positions.len();
            let description = MeshDescription { num_vertices, faces, layers: Some(layers), ..Default::default() };
            let mesh = Mesh::new(description).unwrap();
            let frame = Frame::new(&mesh, &positions).unwrap();
            let behind = Layers::of(&mesh, &frame, None).unwrap().behind(&mesh, frame.positions());
            let found: Vec<usize> = behind.iter().map(|wrong| wrong.vertex.index()).collect();
            let is_within = |&vertex: &usize| expected && vertex >= inner.len() && positions[vertex][2] > -2.0;
            let within: Vec<usize> = (0..num_vertices).filter(is_within).collect();
            assert_eq!(found, within, "{radius} {turned:?}");
            assert!(behind.iter().all(|wrong| (wrong.way.depth_m - 0.1).abs() < 0.02));
        }
    }
}

/// Two square sheets, the second one 0.05 m over the faces of the first, rolled up by an angle towards it.
fn rolled(turn: f64) -> Vec<[f64; 3]> {
    let place = |height: f64, step: u32| {
        let angle = turn * (f64::from(step % 13) / 12.0 - 0.5);
        let radius = 1.0 / turn - height;
        [radius * angle.sin(), f64::from(step / 13) / 12.0, 1.0 / turn - radius * angle.cos()]
    };
    [0.0, 0.05].into_iter().flat_map(|height| (0..169).map(move |step| place(height, step))).collect()
}

#[test]
fn behind_a_sheet_is_by_its_faces_while_it_is_flat_and_by_what_was_decided_once_it_is_rolled_up() {
    let square = |step: u32| {
        let at = step / 12 * 13 + step % 12;
        [[at, at + 1, at + 14], [at, at + 14, at + 13]]
    };
    let sheet: Vec<[u32; 3]> = (0..144).flat_map(square).collect();
    let outer = sheet.iter().map(|face| face.map(|corner| corner + 169));
    // A third of the faces, the first one among them, points the other way.
    let turn = |(index, &[a, b, c]): (usize, &[u32; 3])| if index % 3 == 0 { [a, c, b] } else { [a, b, c] };
    let faces = sheet.iter().enumerate().map(turn).chain(outer).collect();
    let layers = Some((0..338).map(|vertex| u32::from(vertex >= 169)).collect());
    let open = Mesh::new(MeshDescription { num_vertices: 338, faces, layers, ..Default::default() }).unwrap();
    let num_behind = |mesh: &Mesh, positions: &[[f64; 3]]| {
        let frame = Frame::new(mesh, positions).unwrap();
        Layers::of(mesh, &frame, None).unwrap().behind(mesh, frame.positions()).len()
    };
    for turn in [1e-3, 0.01, 0.1, 1.0, 1.5, -1e-3, -0.1, -1.5] {
        assert_eq!(num_behind(&open, &rolled(turn)), 0, "{turn}");
    }
    // Rolled up towards the outer sheet, the inner one winds round it.
    assert!(num_behind(&open, &rolled(3.5)) > 100);
    let decided = Layers::decide(open.clone(), &Frame::new(&open, &rolled(0.1)).unwrap());
    assert_eq!(num_behind(&decided, &rolled(3.5)), 0);
    let again = Layers::decide(decided.clone(), &Frame::new(&open, &rolled(3.5)).unwrap());
    assert_eq!(again.outwards(), decided.outwards());
}
