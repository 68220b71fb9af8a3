//! The analysis of crumpled sheets against brute force, and what must not change it.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod support;

use std::collections::BTreeMap;

use nalgebra::{Point3, Rotation3, Vector3};
use proptest::{prelude::*, test_runner::RngSeed};
use support::{
    brute, rules,
    sheet::{Sheet, crumpled, relabelled},
    summary::{Summary, summary},
};
use untangled::{
    analysis::{Analyser, Analysis, analyse},
    mesh::{EdgeId, FaceId},
    settings::Settings,
};

const RESOLUTIONS: [u32; 4] = [6, 9, 13, 20];
const SHEETS: u64 = 200;

fn sheets() -> impl Iterator<Item = (u64, u32, Sheet)> {
    (0..SHEETS).map(|seed| {
        let resolution = RESOLUTIONS[usize::try_from(seed).unwrap() % RESOLUTIONS.len()];
        (seed, resolution, crumpled(seed, resolution))
    })
}

fn analysis_of(sheet: &Sheet) -> (untangled::mesh::Mesh, Analysis) {
    let mesh = sheet.mesh();
    let analysis = analyse(&mesh, &sheet.frame(&mesh));
    (mesh, analysis)
}

#[test]
fn crumpled_sheets_equal_brute_force_and_obey_all_rules() {
    let mut table: BTreeMap<_, [usize; RESOLUTIONS.len()]> = BTreeMap::new();
    let mut num_pairs = 0;
    for (seed, resolution, sheet) in sheets() {
        let (mesh, analysis) = analysis_of(&sheet);
        let frame = sheet.frame(&mesh);
        let expected = brute::edge_face_intersections(&mesh, &frame);
        let found: Vec<(EdgeId, FaceId)> =
            analysis.intersections.edge_face.iter().map(|hit| (hit.edge, hit.face)).collect();
        assert_eq!(found, expected, "seed {seed}");
        let expected: Vec<[FaceId; 2]> = brute::face_pairs(&mesh, &expected).into_keys().collect();
        let found: Vec<[FaceId; 2]> = analysis.intersections.segments.iter().map(|segment| segment.faces).collect();
        assert_eq!(found, expected, "seed {seed}");
        num_pairs += found.len();
        rules::check(&mesh, &frame, &analysis, 10.0);
        let column = RESOLUTIONS.iter().position(|&other| other == resolution).unwrap();
        for pair in &analysis.paths.pairs {
            table.entry(pair.pair_type).or_default()[column] += 1;
        }
    }
    println!("{SHEETS} sheets, {num_pairs} face pairs; path pairs by type and resolution:");
    println!("{:<14} {:>6} {:>6} {:>6} {:>6}", "type", 6, 9, 13, 20);
    for (pair_type, [a, b, c, d]) in &table {
        let name = serde_json::to_value(pair_type).unwrap();
        println!("{:<14} {a:>6} {b:>6} {c:>6} {d:>6}", name.as_str().unwrap());
    }
    assert!(table.len() >= 5, "too few types to be a test: {table:?}");
}

#[test]
fn names_and_sides_change_nothing() {
    for (seed, _, sheet) in sheets().step_by(3) {
        let (mesh, analysis) = analysis_of(&sheet);
        let expected = summary(&mesh, &analysis, |vertex| vertex, |face| face);
        for turn_over in [false, true] {
            let other = relabelled(&sheet, seed, turn_over);
            let (mesh, analysis) = analysis_of(&other.sheet);
            let inverse = |names: &[u32]| {
                let mut old = vec![0; names.len()];
                for (name, &new) in (0..).zip(names) {
                    old[new as usize] = name;
                }
                old
            };
            let (vertex, face): (Vec<u32>, Vec<u32>) = (inverse(&other.vertex), inverse(&other.face));
            let found = summary(&mesh, &analysis, |new| vertex[new as usize], |new| face[new as usize]);
            assert_same(&found, &expected, &format!("seed {seed}, turned over: {turn_over}"));
        }
    }
}

fn assert_same(found: &Summary, expected: &Summary, what: &str) {
    assert_eq!(found.edge_face, expected.edge_face, "{what}");
    assert_eq!(found.face_pairs, expected.face_pairs, "{what}");
    assert_eq!(found.pairs, expected.pairs, "{what}");
}

#[test]
fn threads_and_history_change_nothing() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let pools = [pool(1), pool(4)];
    for seed in [3, 7, 11, 15] {
        let sheet = crumpled(seed, 20);
        let mesh = sheet.mesh();
        let frame = sheet.frame(&mesh);
        let expected = format!("{:?}", analyse(&mesh, &frame));
        for pool in &pools {
            assert_eq!(format!("{:?}", pool.install(|| analyse(&mesh, &frame))), expected, "seed {seed}");
        }
        // Another state in between: more tangled, then not at all.
        let mut analyser = Analyser::default();
        for (factor, is_same) in [(1.0, true), (3.0, false), (0.0, false), (1.0, true)] {
            let mut other = sheet.clone();
            for position in &mut other.positions {
                position[2] *= factor;
            }
            let other = other.frame(&mesh);
            let found = format!("{:?}", analyser.analyse(&mesh, &other, &Settings::default(), &mut ()));
            if is_same {
                assert_eq!(found, expected, "seed {seed}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 60,
        rng_seed: RngSeed::Fixed(2006),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn rigid_motions_and_scales_change_nothing(
        seed in 0..SHEETS,
        angles in prop::array::uniform3(-3.0..3.0f64),
        shift in prop::array::uniform3(-10.0..10.0f64),
        scale_exponent in -6.0..6.0f64,
    ) {
        let sheet = crumpled(seed, 9);
        let (mesh, analysis) = analysis_of(&sheet);
        let expected = summary(&mesh, &analysis, |vertex| vertex, |face| face);
        let scale = 10f64.powf(scale_exponent);
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let mut moved = sheet.clone();
        for position in &mut moved.positions {
            let point = rotation * Point3::from(*position) + Vector3::from(shift);
            *position = (point.coords * scale).into();
        }
        let (mesh, analysis) = analysis_of(&moved);
        rules::check(&mesh, &moved.frame(&mesh), &analysis, 20.0 * scale);
        let found = summary(&mesh, &analysis, |vertex| vertex, |face| face);
        assert_same(&found, &expected, &format!("seed {seed}"));
    }
}
