//! How near targets come to the truth, on folded sheets where the truth is known.
//!
//! ```sh
//! cargo run --release --example target_table                             # as plain text
//! cargo run --release --example target_table -- --markdown > docs/TARGETS.md
//! ```
//!
//! The sheets are `f(u, v) = (phi(u), v, a tanh(u / e) g(phi(u), v))` with an even `phi`: the layers `u` and `-u` meet exactly where `g` is
//! zero, so that the point of the cloth that belongs to (u, v) is (-u, v). The shape of the curve `g = 0` makes the type of the path.
#![expect(clippy::print_stdout, reason = "an example talks to whoever runs it")]

use std::{env, error::Error};

use nalgebra::Point2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangled::{
    analysis::{Analyser, Analysis},
    correspond::{ChartKind, Correspondent, MaterialPoint},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    paths::PathType,
    settings::Settings,
};

/// Half the side of the sheet, in metres.
const HALF_M: f64 = 1.0;
/// How far a vertex inside stands from its place in the grid, in cells.
const JITTER: f64 = 0.15;
const EDGES_M: [f64; 3] = [0.1, 0.05, 0.025];
const SIZES: [f64; 3] = [0.25, 0.5, 1.0];

/// A curve `g = 0`, by the size of the tangle in 0..=1.
struct Curve {
    name: &'static str,
    path_type: PathType,
    /// `g(phi, v)` for a size.
    level: fn(f64, f64, f64) -> f64,
    /// How far the layer of negative `u` reaches, and how wide it is, for a size, in metres.
    flap: fn(f64) -> [f64; 2],
}

const CURVES: [Curve; 5] = [
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

/// What the mesh tells about its shape.
#[derive(Clone, Copy, PartialEq)]
enum Knowledge {
    Uvs,
    Rest,
    Nothing,
}

const KNOWLEDGE: [(Knowledge, &str); 3] =
    [(Knowledge::Uvs, "UVs"), (Knowledge::Rest, "rest lengths"), (Knowledge::Nothing, "current lengths")];

struct Sheet {
    mesh: Mesh,
    frame: Frame,
    flat: Vec<Point2<f64>>,
}

fn sheet(curve: &Curve, size: f64, edge_m: f64, knowledge: Knowledge) -> Result<Sheet, Box<dyn Error>> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
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
    Ok(Sheet { mesh, frame, flat })
}

struct Row {
    length_edges: f64,
    centres: usize,
    kind: ChartKind,
    residual_edges: f64,
    condition: f64,
    /// Distances of targets from the truth, in edges, ascending.
    errors: Vec<f64>,
}

/// The longest path of the wanted type, and how far its targets are off.
fn measure(sheet: &Sheet, curve: &Curve, edge_m: f64) -> Option<Row> {
    let settings = Settings::default();
    let mut analyser = Analyser::default();
    let analysis: &Analysis = analyser.analyse(&sheet.mesh, &sheet.frame, &settings, &mut ());
    let mut correspondent = Correspondent::default();
    let found = correspondent.find(&sheet.mesh, &sheet.frame, analysis, &settings, &mut ());
    let length = |copy: usize| analysis.paths.pairs[analysis.paths.copies[copy].pair].length_m;
    let path = found
        .paths
        .iter()
        .filter(|path| analysis.paths.copies[path.copy].path_type == curve.path_type)
        .max_by(|a, b| length(a.copy).total_cmp(&length(b.copy)))?;
    let at = |point: &MaterialPoint| {
        let places = point.vertices.iter().zip(point.weights);
        places.fold(Point2::origin(), |sum, (vertex, weight)| sum + sheet.flat[vertex.index()].coords * weight)
    };
    let mut errors: Vec<f64> = found.pulls[path.pulls.clone()]
        .iter()
        .map(|pull| {
            let (from, to) = (at(&pull.source), at(&pull.target));
            (to - Point2::new(-from.x, from.y)).norm() / edge_m
        })
        .collect();
    errors.sort_unstable_by(f64::total_cmp);
    Some(Row {
        length_edges: length(path.copy) / edge_m,
        centres: path.num_centres,
        kind: path.own_chart,
        residual_edges: path.residual_m / edge_m,
        condition: path.condition,
        errors,
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let markdown = env::args().any(|argument| argument == "--markdown");
    let heading = [
        "path",
        "edge",
        "chart from",
        "laid",
        "length",
        "centres",
        "targets",
        "median",
        "max",
        "residual",
        "condition",
    ];
    if markdown {
        println!("# How near targets come to the truth\n");
        println!(
            "Made by `cargo run --release --example target_table -- --markdown > docs/TARGETS.md`; do not edit.\n"
        );
        println!(
            "On folded sheets the target of (u, v) is (-u, v). `edge` is the edge length in metres; `length` of the path, `median` and `max`"
        );
        println!(
            "distance of a target from the true one, and `residual`, by how much the fit misses the path between its centres, are in edge"
        );
        println!(
            "lengths. A chart is unfolded, or relaxed where its faces don't fit together in the plane. The chart from current lengths can't know"
        );
        println!("how the fold has stretched the sheet; the truth it is measured against is that of the flat one.\n");
        println!("| {} |", heading.join(" | "));
        println!("|{}", "---|".repeat(heading.len()));
    } else {
        println!("{}", heading.join("  "));
    }
    for curve in &CURVES {
        for size in SIZES {
            for edge_m in EDGES_M {
                for (knowledge, name) in KNOWLEDGE {
                    let row = measure(&sheet(curve, size, edge_m, knowledge)?, curve, edge_m);
                    print(curve, edge_m, name, row.as_ref(), markdown);
                }
            }
        }
    }
    Ok(())
}

fn print(curve: &Curve, edge_m: f64, chart: &str, row: Option<&Row>, markdown: bool) {
    let cells = match row {
        None => vec!["no such path".to_string()],
        Some(row) => vec![
            if row.kind.relaxed { "relaxed" } else { "unfolded" }.to_string(),
            format!("{:.1}", row.length_edges),
            row.centres.to_string(),
            row.errors.len().to_string(),
            row.errors.get(row.errors.len() / 2).map_or("-".into(), |error| format!("{error:.3}")),
            row.errors.last().map_or("-".into(), |error| format!("{error:.3}")),
            format!("{:.3}", row.residual_edges),
            format!("{:.0e}", row.condition),
        ],
    };
    if markdown {
        let empty = " |".repeat(8 - cells.len());
        println!("| {} | {edge_m} | {chart} | {} |{empty}", curve.name, cells.join(" | "));
    } else {
        let cells: Vec<_> = cells.iter().map(|cell| format!("{cell:>9}")).collect();
        println!("{:<36} {edge_m:<6} {chart:<16} {}", curve.name, cells.join(" "));
    }
}
