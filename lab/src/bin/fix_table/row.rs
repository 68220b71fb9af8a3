//! One row: a mesh, relaxed and judged.

use std::{error::Error, ops::ControlFlow, time::Instant};

use nalgebra::Point3;
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    relax::{Iteration, RelaxSettings, Relaxation, relax},
};
use untangled_checker::count_edge_face;

/// What is said beside the table.
#[derive(Clone, Copy, Default)]
pub(crate) struct Show {
    /// The intersections after each iteration.
    pub(crate) curve: bool,
    /// The same on standard error while it works.
    pub(crate) watch: bool,
}

/// What the summary below the table needs.
pub(crate) struct Row {
    /// Edge-face intersections of the result.
    pub(crate) after: usize,
    pub(crate) iterations: usize,
    /// Least and greatest ratio of an edge's length to that before.
    pub(crate) edges: (f64, f64),
}

/// Relaxes a mesh and prints its row.
pub(crate) fn run(
    name: &str,
    description: &MeshDescription,
    positions: &[[f64; 3]],
    settings: &RelaxSettings,
    show: Show,
) -> Result<Row, Box<dyn Error>> {
    let mesh = Mesh::new(description.clone())?;
    if let Err(error) = Frame::new(&mesh, positions) {
        println!("{name:<28} {error}");
        return Ok(Row { after: 0, iterations: 0, edges: (1.0, 1.0) });
    }
    let before = count_edge_face(positions, &description.faces).unwrap_or(usize::MAX);
    let start = Instant::now();
    let relaxation = relax(&mesh, positions, settings, &mut |step| {
        if show.watch {
            let Iteration { num_edge_face_intersections: left, path_length_m, method, .. } = step;
            eprintln!("{:>8.1} s {left:>8} {path_length_m:>10.4} m {method:?}", start.elapsed().as_secs_f64());
        }
        ControlFlow::Continue(())
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let after = count_edge_face(&relaxation.positions, &description.faces).unwrap_or(usize::MAX);
    let (shortest, longest) = edge_ratios(&mesh, positions, &relaxation.positions);
    let smallest = least_area_ratio(description, positions, &relaxation.positions);
    let moved = greatest_displacement(positions, &relaxation.positions);
    let iterations = relaxation.history.len();
    println!(
        "{name:<28} {before:>8} {after:>6} {iterations:>6} {seconds:>8.2} {shortest:>8.3} {longest:>8.3} \
         {smallest:>8.3} {moved:>8.4}"
    );
    if show.curve {
        print_curve(&relaxation);
    }
    Ok(Row { after, iterations, edges: (shortest, longest) })
}

fn print_curve(relaxation: &Relaxation) {
    let left = relaxation.history.iter().map(|step| format!("{} {:?}", step.num_edge_face_intersections, step.method));
    println!("  {}", left.collect::<Vec<_>>().join(", ").to_lowercase());
}

fn point(positions: &[[f64; 3]], vertex: u32) -> Point3<f64> {
    Point3::from(positions[vertex as usize])
}

/// Least and greatest ratio of an edge's length to that before.
fn edge_ratios(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> (f64, f64) {
    let (mut shortest, mut longest) = (1.0f64, 1.0f64);
    for edge in mesh.edge_ids() {
        let [a, b] = mesh.edge(edge).map(|vertex| vertex.0);
        let length = |positions: &[[f64; 3]]| (point(positions, b) - point(positions, a)).norm();
        let ratio = length(after) / length(before);
        if ratio.is_finite() {
            (shortest, longest) = (shortest.min(ratio), longest.max(ratio));
        }
    }
    (shortest, longest)
}

/// Least ratio of a face's area to that before.
fn least_area_ratio(description: &MeshDescription, before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let ratios = description.faces.iter().map(|&face| {
        let area = |positions: &[[f64; 3]]| {
            let [a, b, c] = face.map(|vertex| point(positions, vertex));
            (b - a).cross(&(c - a)).norm()
        };
        area(after) / area(before)
    });
    ratios.filter(|ratio| ratio.is_finite()).fold(1.0, f64::min)
}

/// Greatest displacement of a vertex, as a part of the diagonal of the bounding box.
fn greatest_displacement(before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let low = before.iter().fold([f64::INFINITY; 3], |low, p| std::array::from_fn(|k| low[k].min(p[k])));
    let high = before.iter().fold([f64::NEG_INFINITY; 3], |high, p| std::array::from_fn(|k| high[k].max(p[k])));
    let diagonal = (Point3::from(high) - Point3::from(low)).norm();
    let moved = before.iter().zip(after).map(|(a, b)| (Point3::from(*b) - Point3::from(*a)).norm());
    moved.fold(0.0, f64::max) / diagonal
}
