//! Steps to no intersection: quasi-static relaxation with the corrections, without a daemon.
//!
//! ```sh
//! cargo run --release --example relax_table -- [--response rbf|contour|displacement|mask] [--rest uv|input] [--steps N]
//!     [--step H] [--stiffness K] [--no-uvs] [--verbose]
//!     [--quality fast|balanced|accurate] FILE...
//! ```
//!
//! Each step moves every vertex by its correction and then makes some iterations of position-based dynamics (Müller, Heidelberger,
//! Hennix and Ratcliff 2007) on edge lengths and on the distances across edges, towards the flat sheet (`uv`) or the shape of the
//! input (`input`).
#![expect(clippy::print_stdout, reason = "an example talks to whoever runs it")]

use std::{env, error::Error, sync::Arc};

use nalgebra::Vector3;
use serde::{
    Deserialize,
    de::{IntoDeserializer, value::Error as ValueError},
};
use untangle::{frame::Frame, mesh::{Mesh, Uvs, VertexId}, settings::{Quality, Response, Settings}, untangler::Untangler};
use untangled_mesh_io::{concatenate, read_mesh};

const PROJECTIONS: usize = 4;
const BENDING: f64 = 0.3;
const HELD: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = Settings::default();
    let (mut flat, mut most, mut verbose, mut strip_uvs) = (true, 100, false, false);
    let mut files = Vec::new();
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--response" => {
                let name = value()?;
                settings.response =
                    Response::deserialize(IntoDeserializer::<ValueError>::into_deserializer(name.as_str()))?;
            }
            "--quality" => {
                let name = value()?;
                Quality::deserialize(IntoDeserializer::<ValueError>::into_deserializer(name.as_str()))?
                    .apply(&mut settings);
            }
            "--rest" => flat = value()? == "uv",
            "--steps" => most = value()?.parse()?,
            "--step" => settings.max_step_edge_lengths = value()?.parse()?,
            "--stiffness" => settings.stiffness_per_step2 = value()?.parse()?,
            "--verbose" => verbose = true,
            "--no-uvs" => strip_uvs = true,
            _ => files.push(argument),
        }
    }
    println!(
        "{:<24} {:>8} {:>6} {:>6} {:>6} {:>7} {:>9} {:>9}",
        "scene", "before", "steps", "held", "after", "stretch", "force", "torque"
    );
    for file in files {
        let Some(scene) = Scene::read(&file, flat, strip_uvs)? else {
            println!("{file:<24} can't be used");
            continue;
        };
        let result = scene.run(&settings, most, verbose)?;
        let name = file.rsplit('/').next().unwrap_or(&file).trim_end_matches(".obj");
        println!("{name:<24} {result}");
    }
    Ok(())
}

struct Scene {
    mesh: Arc<Mesh>,
    positions: Vec<[f64; 3]>,
    /// Pairs of vertices with their wanted distance and stiffness.
    springs: Vec<(usize, usize, f64, f64)>,
}

impl Scene {
    fn read(file: &str, flat: bool, strip_uvs: bool) -> Result<Option<Self>, Box<dyn Error>> {
        let Ok(file) = read_mesh(file) else { return Ok(None) };
        let mut world = concatenate(&[file])?;
        let flat_uvs = if flat { world.description.uvs.clone() } else { None };
        if strip_uvs {
            world.description.uvs = None;
        }
        let (description, positions) = (world.description, world.positions);
        let Ok(mesh) = Mesh::new(description) else { return Ok(None) };
        if Frame::new(&mesh, &positions).is_err() {
            return Ok(None);
        }
        let springs = springs(&mesh, &positions, flat_uvs.as_ref());
        Ok(Some(Self { mesh: Arc::new(mesh), positions, springs }))
    }

    fn run(mut self, settings: &Settings, most: usize, verbose: bool) -> Result<String, Box<dyn Error>> {
        let mut untangler = Untangler::new(self.mesh.clone(), settings.clone())?;
        let lengths = edge_lengths(&self.mesh, &self.positions);
        let (mut before, mut steps, mut held, mut after) = (None, None, true, 0);
        let (mut force, mut torque): (f64, f64) = (0.0, 0.0);
        for step in 0..=most {
            let frame = Frame::new(&self.mesh, &self.positions)?;
            let outcome = untangler.process(&frame, &mut ());
            after = outcome.analysis.intersections.edge_face.len();
            before.get_or_insert(after);
            if verbose {
                let types: Vec<_> =
                    outcome.analysis.paths.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments)).collect();
                let corrections = outcome.corrections;
                println!("  {step:>3} {after:>5} {:>9.4} {types:?}", corrections.max_displacement_m);
                for path in &outcome.correspondences.paths {
                    println!("        {path:?}");
                }
            }
            let (sum, moments) = residual_scale(&frame, &outcome.corrections.forces);
            if sum > 0.0 {
                force = force.max(outcome.corrections.net_force.norm() / sum);
                torque = torque.max(outcome.corrections.net_torque.norm() / moments);
            }
            match (after, steps) {
                (0, None) => steps = Some(step),
                (1.., Some(_)) => held = false,
                _ => {}
            }
            if steps.is_some_and(|first| step >= first + HELD) {
                break;
            }
            for (position, force) in self.positions.iter_mut().zip(&outcome.corrections.forces) {
                for (value, part) in position.iter_mut().zip(force.iter()) {
                    *value += part;
                }
            }
            for _ in 0..PROJECTIONS {
                self.project();
            }
        }
        let stretched = edge_lengths(&self.mesh, &self.positions);
        let stretch = lengths
            .iter()
            .zip(&stretched)
            .map(|(a, b)| (b / a).ln())
            .fold(0.0f64, |m, s| if s.abs() > m.abs() { s } else { m });
        let steps = steps.map_or("-".into(), |steps| steps.to_string());
        let held = if steps == "-" {
            ""
        } else if held {
            "yes"
        } else {
            "no"
        };
        let before = before.unwrap_or(0);
        Ok(format!("{before:>8} {steps:>6} {held:>6} {after:>6} {:>7.2} {force:>9.1e} {torque:>9.1e}", stretch.exp()))
    }

    fn project(&mut self) {
        for &(a, b, wanted, stiffness) in &self.springs {
            let (pa, pb) = (Vector3::from(self.positions[a]), Vector3::from(self.positions[b]));
            let way = pb - pa;
            let length = way.norm();
            if length > 0.0 {
                let move_by = way * (0.5 * stiffness * (length - wanted) / length);
                self.positions[a] = (pa + move_by).into();
                self.positions[b] = (pb - move_by).into();
            }
        }
    }
}

/// Edges, and the pairs of vertices opposite each inner edge, with their lengths in UV or in the world.
fn springs(mesh: &Mesh, positions: &[[f64; 3]], flat: Option<&Uvs>) -> Vec<(usize, usize, f64, f64)> {
    let place = |face: untangle::mesh::FaceId, vertex: VertexId| -> Vector3<f64> {
        let Some(uvs) = flat else { return Vector3::from(positions[vertex.index()]) };
        let corner = mesh.face(face).iter().position(|&v| v == vertex).unwrap_or(0);
        let [u, v] = uvs.coordinates[uvs.corners[face.index()][corner] as usize];
        Vector3::new(u, v, 0.0)
    };
    let mut springs = Vec::new();
    for edge in mesh.edge_ids() {
        let [a, b] = mesh.edge(edge);
        let faces = mesh.edge_faces(edge);
        let length = (place(faces[0], b) - place(faces[0], a)).norm();
        springs.push((a.index(), b.index(), length, 1.0));
        if let &[one, other] = faces {
            let opposite = |face| mesh.face(face).into_iter().find(|&vertex| vertex != a && vertex != b).unwrap_or(a);
            let (c, d) = (opposite(one), opposite(other));
            let gap = if flat.is_none() {
                (place(one, c) - place(other, d)).norm()
            } else {
                let across = |face, vertex| {
                    let (p, q, r) = (place(face, a), place(face, b), place(face, vertex));
                    let along = (q - p).normalize();
                    ((r - p).dot(&along), (r - p - along * (r - p).dot(&along)).norm())
                };
                let ((xc, yc), (xd, yd)) = (across(one, c), across(other, d));
                (xc - xd).hypot(yc + yd)
            };
            springs.push((c.index(), d.index(), gap, BENDING));
        }
    }
    springs
}

fn edge_lengths(mesh: &Mesh, positions: &[[f64; 3]]) -> Vec<f64> {
    mesh.edge_ids()
        .map(|edge| {
            let [a, b] = mesh.edge(edge).map(|vertex| Vector3::from(positions[vertex.index()]));
            (b - a).norm().max(f64::MIN_POSITIVE)
        })
        .collect()
}

/// Sums of the magnitudes of all forces and of their moments about the centre.
fn residual_scale(frame: &Frame, forces: &[Vector3<f64>]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut moments = 0.0;
    let mut centre = Vector3::zeros();
    let mut count = 0.0;
    for (position, force) in frame.positions().iter().zip(forces) {
        if *force != Vector3::zeros() {
            centre += position.coords;
            count += 1.0;
        }
    }
    for (position, force) in frame.positions().iter().zip(forces) {
        sum += force.norm();
        moments += (position.coords - centre / f64::max(count, 1.0)).norm() * force.norm();
    }
    (sum, moments)
}
