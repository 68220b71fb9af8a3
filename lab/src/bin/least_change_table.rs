//! How little `untangled fix` changes: one row for each mesh, judged by a checker that shares no code with it.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin least_change_table -- [--most N] [--seconds S] FILE...
//! ```
//!
//! Columns: faces; edge-face intersections before and after; iterations; mean and largest displacement in percent of
//! the diagonal of the bounding box; least and greatest ratio of an edge's length to that before; least ratio of a
//! face's area; vertices that moved, in percent; processor seconds; the methods in order. `--seconds` ends a mesh after
//! so much processor time.
#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{env, error::Error, ops::ControlFlow};

use cpu_time::ProcessTime;
use nalgebra::Point3;
use untangle::{
    mesh::Mesh,
    relax::{RelaxSettings, Relaxation, relax},
};
use untangled_checker::count_edge_face;
use untangled_mesh_io::{World, concatenate, read_mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = RelaxSettings::default();
    let (mut seconds, mut files) = (f64::INFINITY, Vec::new());
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--most" => settings.max_iterations = value()?.parse()?,
            "--seconds" => seconds = value()?.parse()?,
            _ => files.push(argument),
        }
    }
    println!(
        "{:<32} {:>6} {:>6} {:>6} {:>4} {:>8} {:>8} {:>6} {:>6} {:>6} {:>7} {:>7} methods",
        "mesh", "faces", "before", "after", "it", "mean %", "most %", "short", "long", "area", "moved %", "cpu s"
    );
    for file in files {
        let name = file.rsplit('/').next().unwrap_or(&file);
        match row(&file, &settings, seconds) {
            Ok(row) => println!("{name:<32} {row}"),
            Err(error) => println!("{name:<32} {error}"),
        }
    }
    Ok(())
}

/// Relaxes one mesh and judges the result.
fn row(file: &str, settings: &RelaxSettings, seconds: f64) -> Result<String, Box<dyn Error>> {
    let World { description, positions, .. } = concatenate(&[read_mesh(file)?])?;
    let faces = description.faces.clone();
    let mesh = Mesh::new(description)?;
    let before = count_edge_face(&positions, &faces)?;
    let start = ProcessTime::now();
    let result = relax(&mesh, &positions, settings, &mut |_| {
        if start.elapsed().as_secs_f64() > seconds { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let cpu = start.elapsed().as_secs_f64();
    let after = count_edge_face(&result.positions, &faces)?;
    let [mean, most, moved] = displacements(&positions, &result.positions);
    let (shortest, longest) = edge_ratios(&mesh, &positions, &result.positions);
    let area = least_area_ratio(&faces, &positions, &result.positions);
    let (count, iterations, methods) = (faces.len(), result.history.len(), methods(&result));
    Ok(format!(
        "{count:>6} {before:>6} {after:>6} {iterations:>4} {mean:>8.4} {most:>8.3} {shortest:>6.3} {longest:>6.3} \
         {area:>6.3} {moved:>7.2} {cpu:>7.2} {methods}"
    ))
}

/// The methods of all iterations, those in a row with their number.
fn methods(result: &Relaxation) -> String {
    let mut runs: Vec<(String, usize)> = Vec::new();
    for step in &result.history {
        let name = format!("{:?}", step.method).to_lowercase();
        match runs.last_mut() {
            Some((last, count)) if *last == name => *count += 1,
            _ => runs.push((name, 1)),
        }
    }
    runs.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}

fn point(positions: &[[f64; 3]], vertex: u32) -> Point3<f64> {
    Point3::from(positions[vertex as usize])
}

/// Mean and largest displacement, and how many vertices moved, all in percent.
fn displacements(before: &[[f64; 3]], after: &[[f64; 3]]) -> [f64; 3] {
    let low = before.iter().fold([f64::INFINITY; 3], |low, p| std::array::from_fn(|k| low[k].min(p[k])));
    let high = before.iter().fold([f64::NEG_INFINITY; 3], |high, p| std::array::from_fn(|k| high[k].max(p[k])));
    let diagonal = (Point3::from(high) - Point3::from(low)).norm();
    let (mut sum, mut most, mut moved, mut count) = (0.0, 0.0f64, 0.0, 0.0);
    for (a, b) in before.iter().zip(after) {
        let length = (Point3::from(*b) - Point3::from(*a)).norm();
        sum += length;
        most = most.max(length);
        moved += if a.map(f64::to_bits) == b.map(f64::to_bits) { 0.0 } else { 1.0 };
        count += 1.0;
    }
    [sum / count / diagonal, most / diagonal, moved / count].map(|part| 100.0 * part)
}

/// Least and greatest ratio of an edge's length to that before.
fn edge_ratios(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> (f64, f64) {
    let ratios = mesh.edge_ids().map(|edge| {
        let [a, b] = mesh.edge(edge).map(|vertex| vertex.0);
        let length = |positions: &[[f64; 3]]| (point(positions, b) - point(positions, a)).norm();
        length(after) / length(before)
    });
    ratios
        .filter(|ratio| ratio.is_finite())
        .fold((1.0, 1.0), |(least, most), ratio| (least.min(ratio), most.max(ratio)))
}

/// Least ratio of a face's area to that before.
fn least_area_ratio(faces: &[[u32; 3]], before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let ratios = faces.iter().map(|&face| {
        let area = |positions: &[[f64; 3]]| {
            let [a, b, c] = face.map(|vertex| point(positions, vertex));
            (b - a).cross(&(c - a)).norm()
        };
        area(after) / area(before)
    });
    ratios.filter(|ratio| ratio.is_finite()).fold(1.0, f64::min)
}
