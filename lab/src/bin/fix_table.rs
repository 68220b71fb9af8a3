//! What `untangled fix` makes of meshes: iterations, time, distortion; judged by a checker that shares no code with it.
//!
//! ```sh
//! cargo run --release --example fix_table -- [--quality fast|balanced|accurate] [--most N] [--motions N] [--subdivide N]
//!     [--no-uvs] [--crumple SQUARES] [--frequency F] [--seed N] [--curve] [--watch] FILE...
//! ```
//!
//! `--subdivide N` splits every triangle in four, N times, before; `--motions N` takes every mesh N times, each under another random
//! rigid motion and scale. `--crumple N` takes a sheet of N x N squares under random waves of up to F periods; `--curve` prints what is left after
//! each iteration, `--watch` says it on standard error while it works, with the seconds since the start.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to whoever runs it")]

use std::{collections::HashMap, env, error::Error, ops::ControlFlow, time::Instant};

use nalgebra::{Point3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{
    Deserialize,
    de::{IntoDeserializer, value::Error as ValueError},
};
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    relax::{Effort, Iteration, RelaxSettings, relax},
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_publisher::check::count_edge_face;

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = RelaxSettings::default();
    let (mut motions, mut levels, mut strip_uvs) = (0u64, 0, false);
    let mut files = Vec::new();
    let mut crumples: Vec<u32> = Vec::new();
    let (mut frequency, mut seed, mut show) = (1.6, 1, Show::default());
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--quality" => {
                let name = value()?;
                settings.effort =
                    Effort::deserialize(IntoDeserializer::<ValueError>::into_deserializer(name.as_str()))?;
            }
            "--most" => settings.max_iterations = value()?.parse()?,
            "--motions" => motions = value()?.parse()?,
            "--subdivide" => levels = value()?.parse()?,
            "--no-uvs" => strip_uvs = true,
            "--crumple" => crumples.push(value()?.parse()?),
            "--frequency" => frequency = value()?.parse()?,
            "--seed" => seed = value()?.parse()?,
            "--curve" => show.curve = true,
            "--watch" => show.watch = true,
            _ => files.push(argument),
        }
    }
    println!(
        "{:<28} {:>8} {:>6} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "mesh", "before", "after", "iter", "s", "edge<", "edge>", "area<", "move/D"
    );
    let mut rows: Vec<Row> = Vec::new();
    for squares in crumples {
        let (description, positions) = crumple(squares, frequency, seed);
        let mesh = Mesh::new(description.clone())?;
        rows.push(run(
            &format!("crumple {} triangles", 2 * squares * squares),
            &mesh,
            &description,
            &positions,
            &settings,
            show,
        )?);
    }
    for file in files {
        let name = file.rsplit('/').next().unwrap_or(&file).trim_end_matches(".obj").to_string();
        let Ok(read) = read_mesh(&file) else {
            println!("{name:<28} can't be read");
            continue;
        };
        let world = concatenate(&[read])?;
        let (mut description, mut positions) = (world.description, world.positions);
        if strip_uvs {
            description.uvs = None;
        }
        for _ in 0..levels {
            (description, positions) = subdivide(&description, &positions);
        }
        let Ok(mesh) = Mesh::new(description.clone()) else {
            println!("{name:<28} is no mesh");
            continue;
        };
        if motions == 0 {
            rows.push(run(&name, &mesh, &description, &positions, &settings, show)?);
        }
        for seed in 0..motions {
            let moved = motion(seed, &positions);
            rows.push(run(&format!("{name} #{seed}"), &mesh, &description, &moved, &settings, show)?);
        }
    }
    let clean = rows.iter().filter(|row| row.after == 0).count();
    #[expect(clippy::cast_precision_loss, reason = "counts of a table")]
    let mean = rows.iter().map(|row| row.iterations as f64).sum::<f64>() / rows.len().max(1) as f64;
    println!("{clean} of {} clean, {mean:.1} iterations on the average", rows.len());
    let mut worst: Vec<f64> =
        rows.iter().map(|row| if row.edges.1.ln() > -row.edges.0.ln() { row.edges.1 } else { row.edges.0 }).collect();
    worst.sort_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
    if let Some(median) = worst.get(worst.len() / 2) {
        println!("median of the worst edge ratios: {median:.3}; {:.3} to {:.3}", worst[0], worst[worst.len() - 1]);
    }
    Ok(())
}

/// What is said beside the table.
#[derive(Clone, Copy, Default)]
struct Show {
    curve: bool,
    watch: bool,
}

struct Row {
    after: usize,
    iterations: usize,
    edges: (f64, f64),
}

fn run(
    name: &str,
    mesh: &Mesh,
    description: &MeshDescription,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    show: Show,
) -> Result<Row, Box<dyn Error>> {
    if let Err(error) = Frame::new(mesh, positions) {
        println!("{name:<28} {error}");
        return Ok(Row { after: 0, iterations: 0, edges: (1.0, 1.0) });
    }
    let before = count_edge_face(positions, &description.faces).unwrap_or(usize::MAX);
    let start = Instant::now();
    let relaxation = relax(mesh, positions, settings, &mut |step| {
        if show.watch {
            let Iteration { num_edge_face_intersections: left, path_length_m, method } = step;
            eprintln!("{:>8.1} s {left:>8} {path_length_m:>10.4} m {method:?}", start.elapsed().as_secs_f64());
        }
        ControlFlow::Continue(())
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let after = count_edge_face(&relaxation.positions, &description.faces).unwrap_or(usize::MAX);
    let point = |positions: &[[f64; 3]], vertex: u32| Point3::from(positions[vertex as usize]);
    let (mut shortest, mut longest) = (1.0f64, 1.0f64);
    for edge in mesh.edge_ids() {
        let [a, b] = mesh.edge(edge).map(|vertex| vertex.0);
        let length = |positions: &[[f64; 3]]| (point(positions, b) - point(positions, a)).norm();
        let ratio = length(&relaxation.positions) / length(positions);
        if ratio.is_finite() {
            (shortest, longest) = (shortest.min(ratio), longest.max(ratio));
        }
    }
    let mut smallest = 1.0f64;
    for &face in &description.faces {
        let area = |positions: &[[f64; 3]]| {
            let [a, b, c] = face.map(|vertex| point(positions, vertex));
            (b - a).cross(&(c - a)).norm()
        };
        let ratio = area(&relaxation.positions) / area(positions);
        if ratio.is_finite() {
            smallest = smallest.min(ratio);
        }
    }
    let low = positions.iter().fold([f64::INFINITY; 3], |low, p| std::array::from_fn(|k| low[k].min(p[k])));
    let high = positions.iter().fold([f64::NEG_INFINITY; 3], |high, p| std::array::from_fn(|k| high[k].max(p[k])));
    let diagonal = (Point3::from(high) - Point3::from(low)).norm();
    let moved = positions
        .iter()
        .zip(&relaxation.positions)
        .map(|(a, b)| (Point3::from(*b) - Point3::from(*a)).norm())
        .fold(0.0, f64::max)
        / diagonal;
    let iterations = relaxation.history.len();
    println!(
        "{name:<28} {before:>8} {after:>6} {iterations:>6} {seconds:>8.2} {shortest:>8.3} {longest:>8.3} {smallest:>8.3} {moved:>8.4}"
    );
    if show.curve {
        let left =
            relaxation.history.iter().map(|step| format!("{} {:?}", step.num_edge_face_intersections, step.method));
        println!("  {}", left.collect::<Vec<_>>().join(", ").to_lowercase());
    }
    Ok(Row { after, iterations, edges: (shortest, longest) })
}

/// A random rigid motion and a scale between 1/1000 and 1000.
fn motion(seed: u64, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut unit = || random.random_range(-1.0..1.0);
    let rotation = Rotation3::new(Vector3::new(unit(), unit(), unit()) * std::f64::consts::PI);
    let scale = 10f64.powf(3.0 * unit());
    let shift = Vector3::new(unit(), unit(), unit()) * (10.0 * scale);
    positions.iter().map(|&p| (rotation * Point3::from(p) * scale + shift).into()).collect()
}

/// Splits every triangle in four at the middles of its sides; texture coordinates too.
fn subdivide(description: &MeshDescription, positions: &[[f64; 3]]) -> (MeshDescription, Vec<[f64; 3]>) {
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
    let mut positions = positions.to_vec();
    let faces = split(&description.faces, &mut positions);
    let uvs = description.uvs.as_ref().map(|uvs| {
        let mut coordinates = uvs.coordinates.clone();
        let corners = split(&uvs.corners, &mut coordinates);
        Uvs { coordinates, corners }
    });
    (MeshDescription { num_vertices: positions.len(), faces, uvs, ..Default::default() }, positions)
}

/// A sheet of `squares` by `squares` under waves that push it through itself.
fn crumple(squares: u32, frequency: f64, seed: u64) -> (MeshDescription, Vec<[f64; 3]>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut waves = Vec::new();
    for _ in 0..8 {
        let mut unit = || random.random_range(-1.0..1.0);
        waves.push(([unit(), unit(), unit()], [frequency * unit(), frequency * unit()], std::f64::consts::PI * unit()));
    }
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for row in 0..=squares {
        for column in 0..=squares {
            let (u, v) = (f64::from(column) / f64::from(squares), f64::from(row) / f64::from(squares));
            let mut place = [u, v, 0.0];
            for (direction, frequency, phase) in &waves {
                let wave = (std::f64::consts::TAU * (frequency[0] * u + frequency[1] * v) + phase).sin();
                for (value, part) in place.iter_mut().zip(direction) {
                    *value += 0.2 * part * wave;
                }
            }
            positions.push(place);
            if row < squares && column < squares {
                let a = row * (squares + 1) + column;
                faces.push([a, a + 1, a + squares + 1]);
                faces.push([a + squares + 1, a + 1, a + squares + 2]);
            }
        }
    }
    (MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }, positions)
}
