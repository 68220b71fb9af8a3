//! Meshes made or changed before they are fixed.

use std::{collections::HashMap, error::Error};

use nalgebra::{Point3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;
use untangle::mesh::{Mesh, MeshDescription, Uvs};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::generate::{Sheet, knots::KNOTS, waves::deeply_crumpled};

/// How far [`perturbed`] moves a vertex in each direction, as a part of the diagonal of the bounding box.
const PERTURBATION: f64 = 1e-12;

/// What a mesh is made from, and its positions in metres.
pub(crate) type Shape = (MeshDescription, Vec<[f64; 3]>);

/// The mesh of a file.
pub(crate) fn read(file: &str) -> Result<Shape, Box<dyn Error>> {
    let world = concatenate(&[read_mesh(file)?])?;
    Mesh::new(world.description.clone())?;
    Ok((world.description, world.positions))
}

/// The same mesh a little moved; for odd seeds, under other names of vertices and faces.
pub(crate) fn perturbed(seed: u64, (description, positions): &Shape) -> Shape {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let of_coordinate = |k: usize| positions.iter().map(move |p| p[k]);
    let size = |k| of_coordinate(k).fold(f64::MIN, f64::max) - of_coordinate(k).fold(f64::MAX, f64::min);
    let distance = PERTURBATION * Vector3::new(size(0), size(1), size(2)).norm();
    let mut moved: Vec<[f64; 3]> = positions.clone();
    moved.iter_mut().flatten().for_each(|value| *value += distance * random.random_range(-1.0..1.0));
    let mut description = description.clone();
    if seed % 2 == 1 {
        let mut names: Vec<u32> = (0u32..).take(positions.len()).collect();
        names.shuffle(&mut random);
        let places = moved.clone();
        names.iter().zip(places).for_each(|(&name, place)| moved[name as usize] = place);
        let mut order: Vec<usize> = (0..description.faces.len()).collect();
        order.shuffle(&mut random);
        let faces = &description.faces;
        let renamed = order.iter().map(|&face| faces[face].map(|vertex| names[vertex as usize])).collect();
        if let Some(uvs) = &mut description.uvs {
            uvs.corners = order.iter().map(|&face| uvs.corners[face]).collect();
        }
        description.faces = renamed;
    }
    (description, moved)
}

/// Ten knots with so many vertices around, thicker by a part than there is room for.
pub(crate) fn knots(around: u32, overlap: f64) -> impl Iterator<Item = (&'static str, Shape)> {
    KNOTS.into_iter().map(move |(name, knot)| {
        let (faces, positions) = knot.tube(around, overlap);
        (name, (MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }, positions))
    })
}

/// Folded sheets of `squares` by `squares`, of which the two layers cross each other as a pair of scissors does, from
/// the fold to the boundary, with three slopes beside each other.
pub(crate) fn scissors(squares: u32) -> impl Iterator<Item = (String, Shape)> {
    [0.5, 1.0, 2.0].into_iter().map(move |slope| {
        let sheet = Sheet::fold([-0.793, 0.807], [squares, squares], |_, v| slope * (v - 0.504));
        (format!("scissors {squares}, slope {slope}"), (sheet.bare_description(), sheet.positions))
    })
}

/// A random rigid motion and a scale between 1/1000 and 1000.
pub(crate) fn motion(seed: u64, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut unit = || random.random_range(-1.0..1.0);
    let rotation = Rotation3::new(Vector3::new(unit(), unit(), unit()) * std::f64::consts::PI);
    let scale = 10f64.powf(3.0 * unit());
    let shift = Vector3::new(unit(), unit(), unit()) * (10.0 * scale);
    positions.iter().map(|&p| (rotation * Point3::from(p) * scale + shift).into()).collect()
}

/// Splits every triangle in four at the middles of its sides; texture coordinates too.
pub(crate) fn subdivide((description, positions): &Shape) -> Shape {
    fn split<const N: usize>(faces: &[[u32; 3]], points: &mut Vec<[f64; N]>) -> Vec<[u32; 3]> {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (points[a as usize], points[b as usize]);
                points.push(std::array::from_fn(|k| 0.5 * (p[k] + q[k])));
                u32::try_from(points.len() - 1).expect("a small mesh")
            })
        };
        let mut out = Vec::with_capacity(4 * faces.len());
        for &[a, b, c] in faces {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        out
    }
    let mut positions = positions.clone();
    let faces = split(&description.faces, &mut positions);
    let uvs = description.uvs.as_ref().map(|uvs| {
        let mut coordinates = uvs.coordinates.clone();
        let corners = split(&uvs.corners, &mut coordinates);
        Uvs { coordinates, corners }
    });
    (MeshDescription { num_vertices: positions.len(), faces, uvs, ..Default::default() }, positions)
}

/// A sheet of `squares` by `squares` under waves that push it through itself.
pub(crate) fn crumple(squares: u32, frequency: f64, seed: u64) -> Shape {
    let place = deeply_crumpled(seed, frequency);
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for row in 0..=squares {
        for column in 0..=squares {
            positions.push(place(f64::from(column) / f64::from(squares), f64::from(row) / f64::from(squares)));
            if row < squares && column < squares {
                let a = row * (squares + 1) + column;
                faces.push([a, a + 1, a + squares + 1]);
                faces.push([a + squares + 1, a + 1, a + squares + 2]);
            }
        }
    }
    (MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }, positions)
}
