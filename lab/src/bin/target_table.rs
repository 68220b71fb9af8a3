//! How near targets come to the truth, on folded sheets where the truth is known.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin target_table                             # as plain text
//! cargo run --release -p untangled-lab --bin target_table -- --markdown > docs/results/targets.md
//! ```
//!
//! The sheets are those of the test kit's `generate::mirrored`.
#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{env, error::Error};

use untangle::{
    analysis::Analyser,
    correspond::{ChartKind, Correspondent},
    settings::Settings,
};
use untangled_lab::table::{print_header, print_text};
use untangled_testkit::generate::mirrored::{CURVES, Curve, Knowledge, MirroredSheet, sheet};

const EDGES_M: [f64; 3] = [0.1, 0.05, 0.025];
const SIZES: [f64; 3] = [0.25, 0.5, 1.0];
const KNOWLEDGE: [(Knowledge, &str); 3] =
    [(Knowledge::Uvs, "UVs"), (Knowledge::Rest, "rest lengths"), (Knowledge::Nothing, "current lengths")];

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
fn measure(sheet: &MirroredSheet, edge_m: f64) -> Option<Row> {
    let settings = Settings::default();
    let mut analyser = Analyser::default();
    let analysis = analyser.analyse(&sheet.mesh, &sheet.frame, &settings, &mut ());
    let mut correspondent = Correspondent::default();
    let found = correspondent.find(&sheet.mesh, &sheet.frame, analysis, &settings, &mut ());
    let (path, length_edges) = sheet.path(analysis, found)?;
    Some(Row {
        length_edges,
        centres: path.num_centres,
        kind: path.own_chart,
        residual_edges: path.residual_m / edge_m,
        condition: path.condition,
        errors: sheet.errors(found, path),
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let markdown = env::args().any(|argument| argument == "--markdown");
    print_head(markdown);
    for curve in &CURVES {
        for size in SIZES {
            for edge_m in EDGES_M {
                for (knowledge, name) in KNOWLEDGE {
                    let row = measure(&sheet(curve, size, edge_m, knowledge)?, edge_m);
                    print(curve, edge_m, name, row.as_ref(), markdown);
                }
            }
        }
    }
    Ok(())
}

const HEAD: &str = "\
# How near targets come to the truth

Made by `cargo run --release -p untangled-lab --bin target_table -- --markdown > docs/results/targets.md`; do not edit.

On folded sheets the target of (u, v) is (-u, v). `edge` is the edge length in metres; `length` of the path,
`median` and `max` distance of a target from the true one, and `residual`, by how much the fit misses the path
between its centres, are in edge lengths. A chart is unfolded, or relaxed where its faces don't fit together in the
plane. The chart from current lengths can't know how the fold has stretched the sheet; the truth it is measured
against is that of the flat one.
";

fn print_head(markdown: bool) {
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
        print_text(HEAD);
        print_header(&heading);
    } else {
        println!("{}", heading.join("  "));
    }
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
