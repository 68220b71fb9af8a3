//! A small run of everything: each setting has its row, and each number is one.

#![allow(clippy::unwrap_used, reason = "a test")]

use super::{
    Document, GRAVITY_M_S2, Plan, Plans, Scene, generated,
    measure::{run::run, setup},
    report,
};

fn plan(names: &[&str]) -> Plan {
    Plan { scenes: generated(names, 1, 0.06).unwrap(), target_edges_m: vec![0.1], limit: 6, repeats: 2 }
}

#[test]
fn every_setting_has_finite_figures_in_all_outputs() {
    let (main, gallery, finer) = (plan(&["drop"]), plan(&["gallery"]), plan(&["bag"]));
    let document = Document::measure(&Plans { main, gallery, finer, resolution: 4 }).unwrap();
    let csv = document.csv();
    let mut lines = csv.lines().map(split);
    let heading = lines.next().unwrap();
    let rows: Vec<_> = lines.collect();
    for row in &rows {
        assert_eq!(row.len(), heading.len(), "{row:?}");
        let has_targets = !row[1].contains("contour") && !row[1].contains("mask") || row[0] == "every n-th frame";
        for (name, cell) in heading.iter().zip(row).skip(3) {
            if cell.is_empty() {
                assert!(name.starts_with("target_") && (row[2] != "all" || !has_targets), "{name} of {row:?}");
            } else {
                let value: f64 = cell.parse().unwrap();
                assert!(value.is_finite() && value >= 0.0, "{name} of {row:?}");
            }
        }
    }
    let groups = [setup::presets(), setup::single_factors(), setup::grid(), setup::deadlines(), setup::responses()];
    let markdown = report::markdown(&document, 0.06, 1);
    assert!(markdown.contains("When to choose which") && !markdown.contains("NaN"));
    for variant in groups.iter().flatten() {
        let own = rows.iter().filter(|row| row[0] == variant.axis && row[1] == variant.value);
        let scenes: Vec<_> = own.map(|row| row[2].as_str()).collect();
        let expected: &[&str] = match variant.axis {
            "time for" => &["gallery", "all"],
            "half the edge" => &["bag", "all"],
            _ => &["drop", "all"],
        };
        assert_eq!(scenes, expected, "{} {}", variant.axis, variant.value);
        assert!(markdown.contains(&format!("\n| {} | ", variant.value)), "{} {}", variant.axis, variant.value);
    }
    let plot = document.plot();
    assert!(plot.starts_with("<svg") && plot.ends_with("</svg>\n"));
    assert!(!plot.contains("NaN") && !plot.contains("inf"), "a point without a place");
    let points = plot.matches("stroke-width=\"0.8\"").count();
    assert_eq!(points, setup::grid().len() + 8, "a marker for each point, and eight in the legend");
}

#[test]
fn the_middle_preset_is_where_single_factors_start() {
    let presets = setup::presets();
    let balanced = presets.iter().find(|variant| variant.value == "balanced").unwrap();
    let factors = setup::single_factors();
    for group in factors.chunk_by(|a, b| a.axis == b.axis) {
        let same = group.iter().filter(|variant| variant.setup == balanced.setup).count();
        assert_eq!(same, 1, "{}", group[0].axis);
    }
    for preset in &presets {
        assert!(setup::grid().iter().any(|variant| variant.setup == preset.setup), "{} is no point", preset.value);
    }
}

#[test]
fn a_clean_scene_costs_no_frames() {
    let mut cloth = generated(&["drop"], 1, 0.06).unwrap().remove(0).cloth;
    cloth.positions = cloth.rest_positions.clone();
    let scene = Scene { name: "flat".into(), cloth, gravity_m_s2: GRAVITY_M_S2 };
    let run = run(&scene, &setup::Setup::default(), 20).unwrap();
    assert_eq!((run.clean_at, run.tangled_frames, run.remaining), (Some(0), 0, 0));
}

/// The cells of a line, in which a cell with commas is quoted.
fn split(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            _ => cells.last_mut().unwrap().push(letter),
        }
    }
    cells
}
