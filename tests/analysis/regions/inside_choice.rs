//! Which side of a path is inside, where a user says more than "the smaller one".

use untangle::{
    analysis::{Analyser, Analysis},
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    settings::{InsideChoice, Settings},
};

fn analyse(description: MeshDescription, positions: &[[f64; 3]], settings: &Settings) -> (Mesh, Analysis) {
    let mesh = Mesh::new(description).unwrap();
    let frame = Frame::new(&mesh, positions).unwrap();
    let analysis = Analyser::default().analyse(&mesh, &frame, settings, &mut ()).clone();
    (mesh, analysis)
}

/// Appends a sphere of `n` rings, its faces looking outwards.
fn add_sphere(positions: &mut Vec<[f64; 3]>, faces: &mut Vec<[u32; 3]>, centre: [f64; 3], radius: f64, n: u32) {
    let first = u32::try_from(positions.len()).unwrap();
    let at = |polar: f64, azimuth: f64| {
        let [x, y, z] = centre;
        let ring = radius * polar.sin();
        [x + ring * azimuth.cos(), y + ring * azimuth.sin(), z + radius * polar.cos()]
    };
    let step = std::f64::consts::PI / f64::from(n);
    positions.push(at(0.0, 0.0));
    for i in 1..n {
        for j in 0..2 * n {
            positions.push(at(f64::from(i) * step, (f64::from(j) + 0.3) * step));
        }
    }
    positions.push(at(std::f64::consts::PI, 0.0));
    let ring = |i: u32, j: u32| first + 1 + (i - 1) * 2 * n + j % (2 * n);
    let last = first + 1 + (n - 1) * 2 * n;
    for j in 0..2 * n {
        faces.push([first, ring(1, j), ring(1, j + 1)]);
        for i in 1..n - 1 {
            faces.push([ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)]);
            faces.push([ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)]);
        }
        faces.push([ring(n - 1, j), last, ring(n - 1, j + 1)]);
    }
}

/// A small sphere that is mostly inside of a large one.
fn spheres(flipped: bool) -> (MeshDescription, Vec<[f64; 3]>, usize) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    add_sphere(&mut positions, &mut faces, [0.0; 3], 1.0, 20);
    let num_large = positions.len();
    add_sphere(&mut positions, &mut faces, [0.71, 0.02, 0.05], 0.4, 12);
    if flipped {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    (MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }, positions, num_large)
}

/// The vertices inside of both solids, by distance.
fn in_both(positions: &[[f64; 3]], num_large: usize) -> Vec<u32> {
    let distance = |p: [f64; 3], c: [f64; 3]| (0..3).map(|k| (p[k] - c[k]).powi(2)).sum::<f64>().sqrt();
    let inside = |&(index, &p): &(usize, &[f64; 3])| {
        if index < num_large { distance(p, [0.71, 0.02, 0.05]) < 0.4 } else { distance(p, [0.0; 3]) < 1.0 }
    };
    let indices = positions.iter().enumerate().filter(inside).map(|(index, _)| u32::try_from(index).unwrap());
    indices.collect()
}

fn regions_of(analysis: &Analysis) -> Vec<u32> {
    let mut vertices: Vec<u32> = analysis.regions.vertices.iter().map(|vertex| vertex.0).collect();
    vertices.sort_unstable();
    vertices
}

fn num_differences(a: &[u32], b: &[u32]) -> usize {
    a.iter().filter(|x| !b.contains(x)).count() + b.iter().filter(|x| !a.contains(x)).count()
}

#[test]
fn inside_by_winding_number_of_overlapping_spheres_is_what_both_contain() {
    for flipped in [false, true] {
        let (description, positions, num_large) = spheres(flipped);
        let expected = in_both(&positions, num_large);
        let (_, by_count) = analyse(description.clone(), &positions, &Settings::default());
        let settings = Settings { winding: true, ..Settings::default() };
        let (mesh, by_winding) = analyse(description, &positions, &settings);
        assert!(mesh.is_closed() && mesh.num_pieces() == 2);
        // By count, the cap that looks out is taken for inside; the spheres are polyhedra, so a few vertices differ.
        assert!(num_differences(&regions_of(&by_count), &expected) > 100);
        assert!(num_differences(&regions_of(&by_winding), &expected) <= 4);
    }
}

/// A flat inner sheet and a tilted outer one that is mostly below it.
fn layers() -> (MeshDescription, Vec<[f64; 3]>) {
    let (mut positions, mut faces, mut layers) = (Vec::new(), Vec::new(), Vec::new());
    for layer in 0..2u32 {
        let first = u32::try_from(positions.len()).unwrap();
        for j in 0..=10u32 {
            for i in 0..=10u32 {
                let (x, y) = (f64::from(i), f64::from(j) + 0.01 * f64::from(i));
                positions.push(match layer {
                    0 => [2.0 * x - 7.0, 2.0 * y - 7.0, 0.0],
                    _ => [x + 0.013, y + 0.017, 0.1 * (x - 7.3) + 0.001 * y],
                });
                layers.push(layer);
            }
        }
        for j in 0..10 {
            for i in 0..10 {
                let at = |di: u32, dj: u32| first + (j + dj) * 11 + i + di;
                faces.push([at(0, 0), at(1, 0), at(1, 1)]);
                faces.push([at(0, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    let description =
        MeshDescription { num_vertices: positions.len(), faces, layers: Some(layers), ..Default::default() };
    (description, positions)
}

#[test]
fn inside_with_layers_or_pins_overrides_the_smaller_side() {
    let (description, positions) = layers();
    let below: Vec<u32> = (121..242u32).filter(|&vertex| positions[vertex as usize][2] < 0.0).collect();
    let above: Vec<u32> = (121..242u32).filter(|&vertex| positions[vertex as usize][2] > 0.0).collect();
    assert!(below.len() > above.len());

    let ignored = Settings { layer_order: false, ..Settings::default() };
    assert_eq!(regions_of(&analyse(description.clone(), &positions, &ignored).1), above);
    assert_eq!(regions_of(&analyse(description.clone(), &positions, &Settings::default()).1), below);

    // A body lies further in than all layers, whatever its number.
    for number in [0, 9] {
        let layers = (0..242).map(|vertex| if vertex < 121 { number } else { 1 }).collect();
        let with_body = MeshDescription { body: (0..121).collect(), layers: Some(layers), ..description.clone() };
        assert_eq!(regions_of(&analyse(with_body, &positions, &Settings::default()).1), below, "{number}");
    }

    let pinned = MeshDescription { pins: vec![above[0]], ..description };
    let settings = Settings { pinned_outside: true, ..ignored.clone() };
    assert_eq!(regions_of(&analyse(pinned.clone(), &positions, &settings).1), below);
    assert_eq!(regions_of(&analyse(pinned, &positions, &ignored).1), above);
}

#[test]
fn inside_by_area_and_by_work_of_uneven_faces_differs_from_inside_by_count() {
    // A strip with narrow columns on the right, cut in the middle of its length by a wall.
    let (mut positions, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let columns = [-10.0, -5.0, -1.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5];
    for x in columns {
        positions.extend([[x, 0.0, 0.0], [x, 1.0, 0.1]]);
    }
    for i in 0..8 {
        faces.extend([[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]]);
    }
    let first = u32::try_from(positions.len()).unwrap();
    positions.extend([[0.1, -1.0, -1.0], [0.2, 3.0, -1.1], [0.3, 0.4, 3.0]]);
    faces.push([first, first + 1, first + 2]);
    let description = MeshDescription { num_vertices: positions.len(), faces, ..Default::default() };
    let by = |inside| {
        let settings = Settings { inside, ..Settings::default() };
        regions_of(&analyse(description.clone(), &positions, &settings).1)
    };
    assert_eq!(by(InsideChoice::Count), [0, 1, 2, 3, 4, 5]);
    assert_eq!(by(InsideChoice::Area), (6..18).collect::<Vec<u32>>());
    // The left end is far from the wall, the right one near.
    assert_eq!(by(InsideChoice::Work), (6..18).collect::<Vec<u32>>());
}
