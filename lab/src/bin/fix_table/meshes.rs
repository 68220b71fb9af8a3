//! Meshes made or changed before they are fixed.

use std::collections::HashMap;

use nalgebra::{Point3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::mesh::{MeshDescription, Uvs};
use untangled_testkit::generate::waves::deeply_crumpled;

/// What a mesh is made from, and its positions in metres.
pub(crate) type Shape = (MeshDescription, Vec<[f64; 3]>);

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
