//! Two garments over each other, half an edge apart.
#![expect(clippy::cast_precision_loss, reason = "counts of vertices, faces and waves")]

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::mesh::MeshDescription;

use crate::meshes::Shape;

/// How far the second garment of [`worn_over`] lies off the first one in the mean, and the root mean square of the
/// waves about that, in mean edge lengths.
const OFFSETS: [[f64; 2]; 4] = [[0.5, 0.3], [0.5, 0.6], [0.5, 1.0], [0.2, 0.6]];
/// Waves, and the range of their lengths as parts of the diagonal.
const NUM_WAVES: usize = 6;
const WAVE_LENGTHS: [f64; 2] = [0.1, 0.4];

/// A garment with another one over it that lies too far in by places: its copy, moved along its normals by offsets
/// with waves. In four ways, each with the offset as its name.
pub(crate) fn worn_over(shape: &Shape) -> impl Iterator<Item = (String, Shape)> {
    (0u64..).zip(OFFSETS).map(|(seed, [mean, deviation])| {
        let (description, positions) = shape;
        let points: Vec<Point3<f64>> = positions.iter().map(|&at| at.into()).collect();
        let normals = outward_normals(&description.faces, &points);
        let wave = waves(seed, &points);
        let edge = mean_edge(&description.faces, &points);
        let place =
            |(at, normal): (&Point3<f64>, &Vector3<f64>)| (at + normal * (edge * (mean + deviation * wave(at)))).into();
        let count = u32::try_from(positions.len()).expect("a small mesh");
        let faces = description.faces.iter().copied();
        let faces = faces.clone().chain(faces.map(|face| face.map(|corner| corner + count))).collect();
        let second: Vec<[f64; 3]> = points.iter().zip(&normals).map(place).collect();
        let both = [positions.as_slice(), &second].concat();
        let description = MeshDescription { num_vertices: both.len(), faces, ..Default::default() };
        (format!("{mean} and {deviation} edges"), (description, both))
    })
}

/// Unit normals of the vertices, away from the middle for the most part.
fn outward_normals(faces: &[[u32; 3]], points: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); points.len()];
    for face in faces {
        let [a, b, c] = face.map(|corner| points[corner as usize]);
        face.iter().for_each(|&corner| sums[corner as usize] += (b - a).cross(&(c - a)));
    }
    let middle = points.iter().fold(Vector3::zeros(), |sum, at| sum + at.coords) / points.len().max(1) as f64;
    let outward: f64 = points.iter().zip(&sums).map(|(at, sum)| (at.coords - middle).dot(sum)).sum();
    sums.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros) * outward.signum()).collect()
}

/// A sum of waves with a root mean square of about 1.
fn waves(seed: u64, points: &[Point3<f64>]) -> impl Fn(&Point3<f64>) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), at| (low.inf(at), high.sup(at)));
    let diagonal = (high - low).norm();
    let waves: Vec<(Vector3<f64>, f64)> = (0..NUM_WAVES)
        .map(|_| {
            let way = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
            let length = diagonal * random.random_range(WAVE_LENGTHS[0]..WAVE_LENGTHS[1]);
            (way.normalize() * (TAU / length), random.random_range(0.0..TAU))
        })
        .collect();
    move |at| {
        waves.iter().map(|(way, phase)| (at.coords.dot(way) + phase).sin()).sum::<f64>()
            / (NUM_WAVES as f64 / 2.0).sqrt()
    }
}

/// The mean length of the edges of all faces.
fn mean_edge(faces: &[[u32; 3]], points: &[Point3<f64>]) -> f64 {
    let lengths = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let sum: f64 = lengths.map(|[a, b]| (points[a as usize] - points[b as usize]).norm()).sum();
    sum / (3 * faces.len()) as f64
}
