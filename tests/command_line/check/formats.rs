//! `untangled check` on every kind of input in every format: one mesh, one answer.

use std::{
    fs,
    os::unix::ffi::OsStrExt,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;
use untangled_testkit::{
    files::{
        formats::{self, exact, rounded},
        shared,
    },
    generate::{Sheet, degenerate},
    process::untangled,
};

fn check_all(files: &[&Path]) -> Output {
    let mut command = Command::new(untangled());
    command.arg("check").args(files).args(["--json", "--face-pairs"]).output().unwrap()
}

fn check(file: &Path) -> Output {
    check_all(&[file])
}

/// The report without what differs from file to file.
fn report(file: &Path) -> Value {
    let output = check(file);
    let mut report: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{}: {error}, {output:?}", file.display()));
    let is_clean = report["num_face_pairs"] == 0;
    assert_eq!(output.status.code(), Some(i32::from(!is_clean)), "{}", file.display());
    assert!(output.stderr.is_empty(), "{output:?}");
    assert_contract(&report);
    for field in ["files", "meetings", "time_us"] {
        report[field].take();
    }
    report
}

fn refusal(file: &Path) -> String {
    let output = check(file);
    assert_eq!(output.status.code(), Some(2), "{}: {output:?}", file.display());
    assert!(output.stdout.is_empty());
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

fn count(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count"))
}

fn indices(value: &Value) -> Vec<u64> {
    value.as_array().unwrap().iter().map(count).collect()
}

/// Every field that scripts may rely on, with what it promises.
fn assert_contract(report: &Value) {
    assert_eq!(report["schema"], "untangled.check/1");
    let num_vertices = count(&report["num_vertices"]);
    for field in ["num_faces", "num_pieces", "num_boundary_edges", "num_edge_face_intersections"] {
        count(&report[field]);
    }
    assert_eq!(report["closed"], count(&report["num_boundary_edges"]) == 0);
    assert!(report["manifold"].is_boolean() && report["time_us"].is_object());
    let pairs = report["face_pairs"].as_array().unwrap();
    assert_eq!(pairs.len() as u64, count(&report["num_face_pairs"]));
    let pairs: Vec<Vec<u64>> = pairs.iter().map(indices).collect();
    assert!(pairs.is_sorted() && pairs.iter().all(|pair| pair[0] < pair[1] && pair[1] < count(&report["num_faces"])));
    let paths = report["paths"].as_array().unwrap();
    let along: u64 = paths.iter().map(|path| count(&path["num_segments"])).sum();
    assert_eq!(along, count(&report["num_face_pairs"]));
    let by_type = report["path_pairs"].as_object().unwrap();
    assert!(by_type.values().all(|number| count(number) > 0));
    assert_eq!(by_type.values().map(count).sum::<u64>(), paths.len() as u64);
    for path in paths {
        assert!(by_type.contains_key(path["pair_type"].as_str().unwrap()), "{path}");
        assert_copies(path, num_vertices);
        assert_ends(path, count(&report["num_faces"]));
    }
}

/// The types of copies that each type of pair has.
fn copy_types(pair_type: &str) -> &'static [&'static [&'static str]] {
    match pair_type {
        // On cloth with one side only the two may be one.
        "CLOSED/CLOSED" => &[&["CLOSED", "CLOSED"], &["CLOSED"]],
        "EIGHT" => &[&["CLOSED", "CLOSED"]],
        "LL" => &[&["LL"]],
        "BLI" => &[&["BLI"]],
        "BLB" => &[&["BLB"]],
        "BLLB" => &[&["BLI", "BLI"], &["BLB", "BLB"], &["BLI", "BLB"], &["BLB", "BLI"]],
        "CROSS" | "BB/II" => &[&["BB", "II"]],
        "BB/BI" => &[&["BB", "BI"]],
        "BB/BB" => &[&["BB", "BB"]],
        "BI/BI" => &[&["BI", "BI"]],
        other => panic!("unknown type {other}"),
    }
}

/// What the fields of a pair's copies promise.
fn assert_copies(path: &Value, num_vertices: u64) {
    let pair_type = path["pair_type"].as_str().unwrap();
    let copies = path["copies"].as_array().unwrap();
    let types: Vec<&str> = copies.iter().map(|copy| copy["type"].as_str().unwrap()).collect();
    assert!(copy_types(pair_type).contains(&types.as_slice()), "{pair_type}: {types:?}");
    let is_folded = copies.len() == 1 || pair_type == "BLLB";
    let run: u64 = copies.iter().map(|copy| count(&copy["num_segments"])).sum();
    assert_eq!(run, 2 * count(&path["num_segments"]), "each segment is run through twice");
    assert!(is_folded || copies.iter().all(|copy| copy["num_segments"] == path["num_segments"]));
    for copy in copies {
        let has_region = !["II", "BI"].contains(&copy["type"].as_str().unwrap());
        assert_eq!(copy["inside_vertices"].is_null(), !has_region);
        if has_region {
            let inside = indices(&copy["inside_vertices"]);
            assert!(inside.windows(2).all(|pair| pair[0] < pair[1]) && inside.iter().all(|&v| v < num_vertices));
            assert!(indices(&path["loop_vertices"]).iter().all(|vertex| !inside.contains(vertex)));
            assert!(inside.is_empty() || copy["partitioning"] == true);
        }
    }
}

/// What the fields of a pair's ends promise.
fn assert_ends(path: &Value, num_faces: u64) {
    let is_closed = path["closed"].as_bool().unwrap();
    assert!(path["length_m"].as_f64().unwrap() >= 0.0);
    let ends = path["ends"].as_array().unwrap();
    assert_eq!(ends.len(), if is_closed { 0 } else { 2 });
    for end in ends {
        match end["kind"].as_str().unwrap() {
            "loop" => assert!(indices(&path["loop_vertices"]).contains(&count(&end["vertex"]))),
            "boundary" | "junction" => {
                assert_eq!(indices(&end["edge"]).len(), 2);
                assert!(count(&end["face"]) < num_faces);
            }
            other => panic!("unknown kind of end {other}"),
        }
    }
}

/// Writes a sheet in all formats and checks that they all have one report.
fn check_all_formats(folder: &Path, name: &str, sheet: &Sheet) {
    let write = |end: &str, content: &[u8]| {
        let path = folder.join(format!("{name}_{end}"));
        fs::write(&path, content).unwrap();
        path
    };
    let mut expected = None;
    for (end, content) in exact(sheet) {
        let found = report(&write(end, &content));
        assert_eq!(&found, expected.get_or_insert(found.clone()), "{name}_{end}");
    }
    let single = rounded(sheet);
    if single.positions.iter().flatten().any(|x| !x.is_finite()) {
        return;
    }
    let expected = report(&write("single.obj", &formats::obj(&single, false)));
    assert_eq!(report(&write("single.glb", &formats::glb(&single))), expected, "{name}");
    let address = format!("{name}_single.bin");
    let (document, buffer) = formats::gltf(&single, &address);
    write("single.bin", &buffer);
    assert_eq!(report(&write("single.gltf", &document)), expected, "{name}");
}

#[test]
fn check_of_degenerate_sheets_is_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for (name, sheet) in degenerate::all() {
        check_all_formats(folder.path(), name, &sheet);
    }
}

#[test]
fn check_of_non_finite_coordinates_is_refused_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let (_, mut sheet) = degenerate::all().swap_remove(0);
    for bad in [f64::NAN, f64::INFINITY] {
        sheet.positions[7][1] = bad;
        let mut contents = exact(&sheet);
        contents.push(("single.glb", formats::glb(&sheet)));
        for (end, content) in contents {
            let path = folder.path().join(end);
            fs::write(&path, content).unwrap();
            let text = refusal(&path);
            // OBJ counts from 1, the others from 0; texts have a line.
            let element = if end.ends_with("obj") { "vertex 8" } else { "vertex 7" };
            let is_text = end.ends_with("obj") || end == "ascii.ply";
            assert!(text.contains(end) && (end.ends_with("glb") || text.contains(element)), "{text}");
            assert_eq!(text.contains(&format!("{end}: ")), !is_text, "{text}");
        }
    }
    sheet.positions[7][1] = 1e100;
    for (end, element) in
        [("plain.obj", ":10: vertex 8 has"), ("ascii.ply", ":17: vertex 7 has"), ("big.ply", ": vertex 7 has")]
    {
        let path = folder.path().join(end);
        fs::write(&path, &exact(&sheet).iter().find(|(name, _)| *name == end).unwrap().1).unwrap();
        let text = refusal(&path);
        assert!(text.contains(&format!("{end}{element}")) && text.contains("at most 2^250"), "{text}");
    }
}

/// Cloth with texture coordinates beside a body without: the disc of a folded path is measured in those of the cloth
/// all the same.
#[test]
fn check_of_files_with_and_without_texture_coordinates_uses_them_where_given() {
    let folder = tempfile::tempdir().unwrap();
    let mut cloth = Sheet::fold([-1.0, 0.8], [40, 31], |x, v| v - 0.65 - 0.1 * x);
    // Far from the lengths of the cloth.
    cloth.uvs.iter_mut().for_each(|[u, _]| *u *= 0.3);
    let body = Sheet {
        faces: vec![[0, 1, 2]],
        uvs: vec![[0.0; 2]; 3],
        positions: vec![[9.0, 0.0, 0.0], [10.0, 0.0, 0.0], [9.0, 1.0, 0.0]],
    };
    let write = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let (with, without) =
        (write("with.obj", &formats::obj_with_uvs(&cloth)), write("without.obj", &formats::obj(&cloth, false)));
    let body = write("body.obj", &formats::obj(&body, false));
    let inside = |files: &[&Path]| {
        let report: Value = serde_json::from_slice(&check_all(files).stdout).unwrap();
        assert_eq!(report["path_pairs"], serde_json::json!({"BLI": 1}));
        indices(&report["paths"][0]["copies"][0]["inside_vertices"])
    };
    let expected = inside(&[&with]);
    assert!(!expected.is_empty());
    assert_eq!(inside(&[&with, &body]), expected);
    assert_ne!(inside(&[&without]), expected);
    assert_eq!(inside(&[&without, &body]), inside(&[&without]));
}

#[test]
fn check_of_file_names_that_are_no_text_reads_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(std::ffi::OsStr::from_bytes(b"caf\xe9 \xff.obj"));
    fs::write(&path, formats::obj(&degenerate::all().swap_remove(0).1, false)).unwrap();
    report(&path);
    assert!(refusal(&path.with_extension("ply")).contains("can't be read"));
}

#[test]
fn check_of_shared_scenes_keeps_the_report_contract_in_every_format() {
    let temporary = tempfile::tempdir().unwrap();
    for folder in ["scenes", "scenes/units"] {
        let Some(folder) = shared(folder) else { return };
        let mut files: Vec<PathBuf> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
        files.retain(|path| path.extension().is_some_and(|extension| extension == "obj"));
        files.sort();
        assert!(!files.is_empty());
        for file in files {
            let name = file.file_stem().unwrap().to_str().unwrap();
            if name == "deg_nan_coarse" {
                assert!(refusal(&file).contains("coordinate"));
                continue;
            }
            report(&file);
            if name.starts_with("deg_") {
                let mesh = untangled_mesh_io::read_mesh(&file).unwrap();
                let (faces, positions) = (mesh.faces().to_vec(), mesh.positions().to_vec());
                let sheet = Sheet { faces, uvs: vec![[0.0; 2]; positions.len()], positions };
                check_all_formats(temporary.path(), name, &sheet);
            }
        }
    }
}
