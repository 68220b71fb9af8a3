//! Two flat sheets as layers: their faces say what is outwards, whatever a dent or a bow does to them.

use std::{fs, path::Path};

use untangled_checker::crossings;
use untangled_mesh_io::read_mesh;
use untangled_testkit::{
    files::formats::{ascii_ply, obj, rounded},
    generate::Sheet,
};

use super::{check, layers::num_behind};
use crate::mesh_folder::{code, fix, json};

/// How far apart the sheets are, in metres.
const APART: f64 = 0.03;

/// A square of one metre, at a height.
fn square(is_turned: bool, height: impl Fn(f64, f64) -> f64) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 1.0], [0.0, 1.0], [12, 12], |x, y| [x, y, height(x, y)]);
    sheet.faces.iter_mut().filter(|_| is_turned).for_each(|face| face.swap(1, 2));
    sheet
}

/// An inner sheet that is bowed, and one on the side of its faces, dented through it by `dent` in the middle.
fn sheets(bow: f64, dent: f64, is_turned: bool) -> [Sheet; 2] {
    use std::f64::consts::PI;
    let up = if is_turned { -1.0 } else { 1.0 };
    let bow = move |x: f64, y: f64| bow * (PI * x).sin() * (PI * y).sin();
    let dent = move |x: f64, y: f64| dent * (-40.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2))).exp();
    [
        square(is_turned, move |x, y| up * bow(x, y)),
        square(is_turned, move |x, y| up * (bow(x, y) + APART - dent(x, y))),
    ]
}

/// Writes both sheets, and gives back their names.
fn write(folder: &Path, sheets: &[Sheet; 2], format: &str) -> [String; 2] {
    ["a", "b"]
        .into_iter()
        .zip(sheets)
        .map(|(name, sheet)| {
            let (end, bytes) = match format {
                "obj" => ("obj", obj(sheet, false)),
                "double" => ("ply", ascii_ply(sheet)),
                _ => (
                    "ply",
                    String::from_utf8(ascii_ply(&rounded(sheet))).unwrap().replace("double", "float").into_bytes(),
                ),
            };
            let name = format!("{name}.{end}");
            fs::write(folder.join(&name), bytes).unwrap();
            name
        })
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

fn positions(folder: &Path, names: &[String; 2]) -> Vec<[f64; 3]> {
    names.iter().flat_map(|name| read_mesh(folder.join(name)).unwrap().positions().to_vec()).collect()
}

#[test]
fn fix_of_flat_layers_with_a_dent_through_each_other_moves_the_dent_alone_in_each_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("out")).unwrap();
    for (bow, dent) in [(0.0, 0.033), (0.02, 0.0315), (-0.02, 0.0315), (0.1, 0.033), (-0.1, 0.033)] {
        for is_turned in [false, true] {
            let sheets = sheets(bow, dent, is_turned);
            for format in ["obj", "double", "single"] {
                let case = format!("bow {bow}, turned {is_turned}, {format}");
                let names = write(path, &sheets, format);
                let [a, b] = [0, 1].map(|layer| names[layer].as_str());
                let output = fix(&[a, b, "--layers", "-o", "out", "--overwrite", "--json"], path);
                let report = json(&output);
                assert_eq!(code(&output), 0, "{case}: {}", report["layers"]);
                let behind = &report["layers"][1]["num_vertices_behind"];
                assert_eq!((&behind["before"], &behind["after"]), (&1.into(), &0.into()), "{case}");
                let [before, after] = [positions(path, &names), positions(&path.join("out"), &names)];
                let bits = |position: &[f64; 3]| position.map(f64::to_bits);
                let moved = before.iter().zip(&after).filter(|(before, after)| bits(before) != bits(after)).count();
                assert!(moved < 40, "{case}: {moved} vertices moved");
                let farthest = report["distortion"]["max_displacement_m"].as_f64();
                assert!(farthest > Some(0.001) && farthest < Some(0.006), "{case}: {farthest:?}");
                assert_eq!(num_behind(path, &[a, b], &after), 0, "{case}");
                let count = u32::try_from(sheets[0].positions.len()).unwrap();
                let outer = sheets[1].faces.iter().map(|face| face.map(|corner| corner + count));
                let faces: Vec<[u32; 3]> = sheets[0].faces.iter().copied().chain(outer).collect();
                assert!(crossings(&after, &faces).unwrap().pairs.is_empty(), "{case}");
            }
        }
    }
}

#[test]
fn check_of_flat_layers_counts_behind_by_the_faces_of_the_inner_one_and_none_in_the_same_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for bow in [0.0, 0.02, -0.02, 0.1, -0.1] {
        for (is_turned, is_outer_turned) in [(false, false), (true, false), (false, true), (true, true)] {
            for format in ["obj", "double", "single"] {
                let mut sheets = sheets(bow, 0.0, is_turned);
                if is_outer_turned {
                    sheets[1].faces.iter_mut().for_each(|face| face.swap(1, 2));
                }
                let num_behind = |sheets: &[Sheet; 2]| {
                    let names = write(path, sheets, format);
                    let report = check(&[&names[0], &names[1], "--layers"], path).1;
                    report["layers"][1]["num_vertices_behind"].as_u64().unwrap()
                };
                let case = format!("bow {bow}, turned {is_turned} {is_outer_turned}, {format}");
                assert_eq!(num_behind(&sheets), 0, "{case}");
                let across = if is_turned { 2.0 * APART } else { -2.0 * APART };
                sheets[1].positions.iter_mut().for_each(|position| position[2] += across);
                assert!(num_behind(&sheets) >= 100, "{case}");
                sheets[1].positions = sheets[0].positions.clone();
                assert_eq!(num_behind(&sheets), 0, "{case}");
            }
        }
    }
}
