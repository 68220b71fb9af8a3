//! Folded sheets on which the truth about targets is known.
//!
//! The sheets are `f(u, v) = (phi(u), v, a tanh(u / e) g(phi(u), v))` with an even `phi`: the layers `u` and `-u` meet
//! exactly where `g` is zero, so that the point of the cloth that belongs to (u, v) is (-u, v). The shape of the curve
//! `g = 0` makes the type of the path.

use std::error::Error;

use nalgebra::Point2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{
    analysis::Analysis,
    correspond::{Correspondences, MaterialPoint, PathCorrespondence},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    paths::PathType,
};

/// Half the side of the sheet, in metres.
const HALF_M: f64 = 1.0;
/// How far a vertex inside stands from its place in the grid, in cells.
const JITTER: f64 = 0.15;

/// What a mesh tells about its shape at rest, and so what charts are made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// Texture coordinates: they are the chart.
    Uvs,
    /// Rest positions: charts are computed from the lengths of their edges.
    Rest,
    /// Nothing: charts are computed from the lengths of the frame.
    Nothing,
}

/// A curve `g = 0`, by the size of the tangle in 0..=1.
#[derive(Debug)]
pub struct Curve {
    /// For tables.
    pub name: &'static str,
    path_type: PathType,
    /// `g(phi, v)` for a size.
    level: fn(f64, f64, f64) -> f64,
    /// How far the layer of negative `u` reaches, and how wide it is, for a size, in metres.
    flap: fn(f64) -> [f64; 2],
}

/// One curve for each way a fold can go through itself.
pub const CURVES: [Curve; 5] = [
    Curve {
        name: "LL, half an ellipse on the crease",
        path_type: PathType::LoopLoop,
        level: |size, phi, v| (phi / (0.7 * size)).powi(2) + (v / (0.6 * size)).powi(2) - 1.0,
        flap: |_| [HALF_M, HALF_M],
    },
    Curve {
        name: "CLOSED, an ellipse off the crease",
        path_type: PathType::Closed,
        level: |size, phi, v| ((phi - 0.5) / (0.3 * size)).powi(2) + (v / (0.6 * size)).powi(2) - 1.0,
        flap: |_| [HALF_M, HALF_M],
    },
    Curve {
        name: "BB/II, a straight line over a flap",
        path_type: PathType::BoundaryBoundary,
        level: |_, phi, _| 0.4 - phi,
        flap: |size| [0.75, 0.7 * size],
    },
    Curve {
        name: "BB/II, a bow over a flap",
        path_type: PathType::BoundaryBoundary,
        level: |size, phi, v| 0.5 - phi - 0.35 * size * (v / (0.7 * size)).powi(2),
        flap: |size| [0.8, 0.7 * size],
    },
    Curve {
        name: "BLI, from the crease over the edge",
        path_type: PathType::BoundaryLoopInside,
        level: |_, phi, v| v + 0.1 + 0.3 * phi,
        flap: |size| [0.75 * size, HALF_M],
    },
];

/// A folded sheet with the known target of each of its points.
#[derive(Debug)]
pub struct MirroredSheet {
    /// Its mesh.
    pub mesh: Mesh,
    /// Where it is.
    pub frame: Frame,
    path_type: PathType,
    edge_m: f64,
    /// (u, v) of each vertex.
    flat: Vec<Point2<f64>>,
}

/// Builds the sheet of a curve with a tangle of a size in 0..=1 and triangles of about `edge_m`.
///
/// # Errors
/// None for the curves of this file.
pub fn sheet(curve: &Curve, size: f64, edge_m: f64, knowledge: Knowledge) -> Result<MirroredSheet, Box<dyn Error>> {
    let (flat, mut faces) = jittered_grid(edge_m);
    let [reach, width] = (curve.flap)(size);
    faces.retain(|face| {
        face.iter().all(|&corner| {
            let p = flat[corner as usize];
            // The flap tapers into the sheet, so that its sides are no straight lines of the grid either.
            p.x > -2.0 * edge_m || (p.x > -reach && p.y.abs() < width)
        })
    });
    let uvs = Uvs { coordinates: flat.iter().map(|p| [p.x, p.y]).collect(), corners: faces.clone() };
    let rest = flat.iter().map(|p| [p.x, p.y, 0.0]).collect();
    let mesh = Mesh::new(MeshDescription {
        num_vertices: flat.len(),
        faces,
        uvs: (knowledge == Knowledge::Uvs).then_some(uvs),
        rest_positions: (knowledge == Knowledge::Rest).then_some(rest),
        ..MeshDescription::default()
    })?;
    let positions: Vec<_> = flat
        .iter()
        .map(|p| {
            let phi = (p.x * p.x + 0.01).sqrt() - 0.1;
            [phi, p.y, 0.15 * (p.x / 0.15).tanh() * (curve.level)(size, phi, p.y).clamp(-1.0, 1.0)]
        })
        .collect();
    let frame = Frame::new(&mesh, &positions)?;
    Ok(MirroredSheet { mesh, frame, path_type: curve.path_type, edge_m, flat })
}

/// A square of triangles with edges of about `edge_m`: its inner vertices moved a little, its diagonals of random
/// direction.
fn jittered_grid(edge_m: f64) -> (Vec<Point2<f64>>, Vec<[u32; 3]>) {
    let cells = 2 * (HALF_M / edge_m).round() as u32;
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut flat = Vec::new();
    for row in 0..=cells {
        for column in 0..=cells {
            let mut place = |index: u32| {
                let jitter = if index > 0 && index < cells { rng.random_range(-JITTER..JITTER) } else { 0.0 };
                (f64::from(index) + jitter) * edge_m - HALF_M
            };
            flat.push(Point2::new(place(column), place(row)));
        }
    }
    let mut faces = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let a = row * (cells + 1) + column;
            let (b, d, c) = (a + 1, a + cells + 1, a + cells + 2);
            let halves = if rng.random_bool(0.5) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            faces.extend(halves);
        }
    }
    (flat, faces)
}

impl MirroredSheet {
    /// The longest path of the curve's type that has targets, and its length in edges.
    pub fn path<'a>(&self, analysis: &Analysis, found: &'a Correspondences) -> Option<(&'a PathCorrespondence, f64)> {
        let length = |copy: usize| analysis.paths.pairs[analysis.paths.copies[copy].pair].length_m;
        found
            .paths
            .iter()
            .filter(|path| analysis.paths.copies[path.copy].path_type == self.path_type)
            .map(|path| (path, length(path.copy) / self.edge_m))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Distances of a path's targets from the truth, in edges, ascending.
    pub fn errors(&self, found: &Correspondences, path: &PathCorrespondence) -> Vec<f64> {
        let at = |point: &MaterialPoint| {
            let places = point.vertices.iter().zip(point.weights);
            places.fold(Point2::origin(), |sum, (vertex, weight)| sum + self.flat[vertex.index()].coords * weight)
        };
        let mut errors: Vec<f64> = found.attractions[path.attractions.clone()]
            .iter()
            .map(|attraction| {
                let (from, to) = (at(&attraction.source), at(&attraction.target));
                (to - Point2::new(-from.x, from.y)).norm() / self.edge_m
            })
            .collect();
        errors.sort_unstable_by(f64::total_cmp);
        errors
    }
}
