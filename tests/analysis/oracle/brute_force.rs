//! The analysis of 200 crumpled sheets against brute force and the rules, with a table of the types of paths.

use std::{collections::BTreeMap, fmt::Write};

use untangle::analysis::analyse;
use untangled_testkit::{
    generate::{Sheet, crumpled},
    judge::{brute_force, rules},
};

const RESOLUTIONS: [u32; 4] = [6, 9, 13, 20];
const SHEETS: u64 = 200;

fn sheets() -> impl Iterator<Item = (u64, u32, Sheet)> {
    (0..SHEETS).map(|seed| {
        let resolution = RESOLUTIONS[usize::try_from(seed).unwrap() % RESOLUTIONS.len()];
        (seed, resolution, crumpled(seed, resolution))
    })
}

#[test]
fn analysis_of_crumpled_sheets_equals_brute_force_and_obeys_all_rules() {
    let mut table: BTreeMap<_, [usize; RESOLUTIONS.len()]> = BTreeMap::new();
    let mut num_pairs = 0;
    for (seed, resolution, sheet) in sheets() {
        let mesh = sheet.mesh();
        let frame = sheet.frame(&mesh);
        let analysis = analyse(&mesh, &frame);
        brute_force::assert_equal(&format!("seed {seed}"), &mesh, &frame, &analysis);
        num_pairs += analysis.intersections.segments.len();
        rules::check(&mesh, &frame, &analysis, 10.0);
        let column = RESOLUTIONS.iter().position(|&other| other == resolution).unwrap();
        for pair in &analysis.paths.pairs {
            table.entry(pair.pair_type).or_default()[column] += 1;
        }
    }
    let mut text = format!(
        "{SHEETS} sheets, {num_pairs} face pairs:\n\n| type | n = 6 | 9 | 13 | 20 | all |\n|---|---|---|---|---|---|\n"
    );
    for (pair_type, counts) in &table {
        let name = serde_json::to_value(pair_type).unwrap();
        let cells = counts.map(|count| count.to_string()).join(" | ");
        writeln!(text, "| {} | {cells} | {} |", name.as_str().unwrap(), counts.iter().sum::<usize>()).unwrap();
    }
    println!("{text}");
    let document = include_str!("../../../docs/results/stages.md");
    assert!(document.contains(&text), "docs/results/stages.md says something else than:\n{text}");
    assert!(table.len() >= 5, "too few types to be a test: {table:?}");
}
