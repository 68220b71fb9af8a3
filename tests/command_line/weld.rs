//! `--weld` of `untangled check` and `untangled fix`.

#![expect(clippy::float_cmp, reason = "what was one place must stay one place to the bit")]

use std::{fs, path::Path};

use serde_json::{Value, json};
use untangled_testkit::files::shared;

use crate::mesh_folder::{code, command, complaint, fix, json};

/// A sheet in the plane of height 0 whose middle column of vertices is there twice, and a triangle through it there.
const SEAM: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 2 0\nv 1 2 0\nv 1 0 0\nv 2 0 0\nv 1 1 -0\nv 2 1 0\n\
                    v 1 2 0\nv 2 2 0\nf 1 2 4 3\nf 3 4 6 5\nf 7 8 10 9\nf 9 10 12 11\n";
const SPIKE: &str = "v 1.02 1.05 -0.2\nv 0.8 0.9 1\nv 1.2 0.9 1.1\nf 1 2 3\n";

fn check(arguments: &[&str], folder: &Path) -> Value {
    json(&command("check", folder).args(arguments).arg("--json").output().unwrap())
}

fn vertices(path: &Path) -> Vec<[f64; 3]> {
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("v "));
    rows.map(|row| {
        let mut numbers = row.split_whitespace().map(|number| number.parse::<f64>().unwrap());
        std::array::from_fn(|_| numbers.next().unwrap())
    })
    .collect()
}

/// Pairs of vertices in one place before that are in two after.
fn num_torn(before: &Path, after: &Path) -> usize {
    let [before, after] = [before, after].map(vertices);
    let mut torn = 0;
    for i in 0..before.len() {
        torn += (0..i).filter(|&j| before[i] == before[j] && after[i] != after[j]).count();
    }
    torn
}

#[test]
fn check_with_each_weld_counts_what_it_welded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("seam.obj"), SEAM).unwrap();
    let report = check(&["seam.obj"], path);
    assert_eq!((&report["num_vertices"], &report["num_welded_vertices"]), (&12.into(), &3.into()));
    assert_eq!((&report["num_pieces"], &report["num_boundary_edges"]), (&1.into(), &8.into()));
    let report = check(&["seam.obj", "--weld", "off"], path);
    assert_eq!((&report["num_welded_vertices"], &report["num_pieces"]), (&0.into(), &2.into()));
    fs::write(path.join("near.obj"), SEAM.replace("v 1 1 -0\n", "v 1 1.0001 0\n")).unwrap();
    assert_eq!(check(&["near.obj"], path)["num_welded_vertices"], 0);
    assert_eq!(check(&["near.obj", "--weld", "1e-3"], path)["num_welded_vertices"], 3);
    let text = command("check", path).arg("seam.obj").output().unwrap();
    assert!(String::from_utf8_lossy(&text.stdout).contains("3 vertices are one with another in the same place"));
    for wrong in ["-1", "1mm"] {
        assert_eq!(code(&command("check", path).args(["seam.obj", "--weld", wrong]).output().unwrap()), 2);
    }
}

#[test]
fn check_of_a_welded_mesh_names_vertices_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // The spike goes down through the seam; of the sheet one welded vertex lies inside, of which both copies are named.
    fs::write(path.join("seam.obj"), SEAM).unwrap();
    let skirt = "v 0.6 0.6 0.5\nv 1.4 0.7 0.5\nv 1 1.5 0.5\nv 1.01 1.02 -0.5\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(path.join("cone.obj"), skirt).unwrap();
    let report = check(&["seam.obj", "cone.obj"], path);
    let inside: Vec<&Value> =
        report["paths"].as_array().unwrap().iter().flat_map(|path| path["copies"].as_array().unwrap()).collect();
    let inside: Vec<&Value> = inside.into_iter().map(|copy| &copy["inside_vertices"]).collect();
    assert!(inside.contains(&&json!([3, 8])) && inside.contains(&&json!([15])), "{report}");
}

#[test]
fn fix_moves_the_copies_of_a_welded_vertex_to_one_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("seam.obj"), SEAM).unwrap();
    fs::write(path.join("spike.obj"), SPIKE).unwrap();
    fs::create_dir(path.join("out")).unwrap();
    let report = json(&fix(&["seam.obj", "spike.obj", "-o", "out", "--json"], path));
    assert_eq!((&report["clean"], &report["num_welded_vertices"]), (&true.into(), &3.into()));
    assert_eq!(num_torn(&path.join("seam.obj"), &path.join("out/seam.obj")), 0);
    // A pin holds all copies.
    fs::write(path.join("pins.txt"), "8\n12 13 14\n").unwrap();
    let report =
        json(&fix(&["seam.obj", "spike.obj", "-o", "out", "--overwrite", "--pin", "pins.txt", "--json"], path));
    assert_eq!(report["num_welded_vertices"], 3);
    let after = vertices(&path.join("out/seam.obj"));
    assert_eq!((after[3], after[8]), ([1.0, 1.0, 0.0], [1.0, 1.0, 0.0]));
    let text = complaint(&["seam.obj", "-o", "x.obj", "--pin", "none"], path);
    assert!(text.contains("none: can't be read"), "{text}");
}

#[test]
fn check_of_seams_of_the_cases_is_as_of_their_welded_twins() {
    let Some(cases) = shared("cases") else { return };
    let made = cases.join("made");
    for name in ["seam_two_faces", "tube_3x1_seam", "tube_6x1_seam", "tube_6x3_seam", "tube_24x8_seam"] {
        assert_eq!(check(&[&format!("{name}.obj")], &made)["num_face_pairs"], 0, "{name}");
    }
    for name in ["fan4", "fan6", "fan8"] {
        let [soup, welded] = ["soup", "welded"].map(|kind| check(&[&format!("{name}_{kind}.obj")], &made));
        for field in ["num_face_pairs", "num_pieces", "num_boundary_edges", "closed", "manifold", "path_pairs"] {
            assert_eq!(soup[field], welded[field], "{name} {field}");
        }
    }
    let [apart, sewn] = ["pocket_unwelded.obj", "pocket.obj"].map(|name| check(&[name], &made));
    assert_eq!(apart["num_welded_vertices"], 81);
    for field in ["num_face_pairs", "num_boundary_edges", "path_pairs"] {
        assert_eq!(apart[field], sewn[field], "pocket {field}");
    }
    let suit = "male_casualsuit02_split_at_uv_seams.obj";
    let makehuman = cases.join("makehuman");
    assert_eq!(check(&[suit], &makehuman)["num_face_pairs"], 0);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.obj");
    assert_eq!(code(&fix(&[suit, "-o", out.to_str().unwrap()], &makehuman)), 0);
    assert_eq!(fs::read(out).unwrap(), fs::read(makehuman.join(suit)).unwrap());
}

#[test]
fn fix_of_a_pocket_of_doubled_vertices_keeps_its_seam_shut() {
    let Some(made) = shared("cases/made") else { return };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.obj");
    let report = json(&fix(&["pocket_unwelded.obj", "-o", out.to_str().unwrap(), "--json"], &made));
    assert_eq!(report["clean"], true, "{report}");
    assert!(report["distortion"]["max_displacement_m"].as_f64().unwrap() > 0.0);
    assert_eq!(num_torn(&made.join("pocket_unwelded.obj"), &out), 0);
}
