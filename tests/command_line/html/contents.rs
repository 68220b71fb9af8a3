//! What a page holds: positions, paths, regions and numbers as the files and the JSON have them.

use serde_json::Value;
use untangled_mesh_io::read_mesh;
use untangled_testkit::generate::{
    Sheet,
    outfits::{Outfit, Pose},
    waves::crumpled,
};

use super::{count, distance, document, positions, singles, whole, write};
use crate::mesh_folder::{code, command, fix, folder, json};

/// The lines of a state, by path: its points in the world, relative to the centre.
fn lines(state: &Value) -> Vec<(usize, Vec<[f64; 3]>)> {
    let points = singles(&state["points"]);
    let point = |i: usize| [0, 1, 2].map(|axis| points[3 * i + axis]);
    whole(&state["lines"]).chunks_exact(3).map(|row| (row[0], (row[1]..row[1] + row[2]).map(point).collect())).collect()
}

/// The lines of all paths have as many segments, and are as long, as the report says.
fn assert_lines_fit(state: &Value, paths: &Value) {
    let paths = paths.as_array().unwrap();
    let (mut segments, mut lengths) = (vec![0; paths.len()], vec![0.0; paths.len()]);
    for (path, points) in lines(state) {
        segments[path] += points.len() - 1;
        lengths[path] += points.windows(2).map(|ends| distance(ends[0], ends[1])).sum::<f64>();
    }
    for (number, path) in paths.iter().enumerate() {
        assert_eq!(segments[number], count(&path["num_segments"]), "{path}");
        let length = path["length_m"].as_f64().unwrap();
        assert!((lengths[number] - length).abs() <= 1e-5 * length.max(0.1), "{path}: {}", lengths[number]);
    }
}

#[test]
fn page_of_a_check_holds_the_mesh_and_its_paths_and_changes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "cloth.obj", &crumpled(7, 40));
    let run = |page: bool| {
        let mut command = command("check", path);
        command.args(["cloth.obj", "--json"]).args(if page { &["--html", "page.html"][..] } else { &[] });
        command.output().unwrap()
    };
    let (with, without) = (run(true), run(false));
    assert_eq!((code(&with), code(&without)), (1, 1));
    let [mut report, mut plain] = [json(&with), json(&without)];
    let page = document(&path.join("page.html"));
    assert_eq!(page["report"], report, "the page holds the document that was printed");
    report["time_us"].take();
    plain["time_us"].take();
    assert_eq!(report, plain, "with a page the same is printed");

    let mesh = read_mesh(path.join("cloth.obj")).unwrap();
    let state = &page["states"][0];
    let found = positions(&page, state);
    assert_eq!(found.len(), mesh.positions().len());
    assert!(found.iter().zip(mesh.positions()).all(|(&a, &b)| distance(a, b) < 1e-6));
    let corners: Vec<usize> = mesh.faces().iter().flatten().map(|&vertex| vertex as usize).collect();
    assert_eq!(whole(&page["mesh"]["triangles"]), corners);
    assert_eq!(page["mesh"]["parts"][0]["file"], "cloth.obj");
    assert!(report["paths"].as_array().unwrap().len() > 5, "there is something to hold");
    let types = report["path_pairs"].as_object().unwrap();
    assert!(["BLI", "LL", "CLOSED/CLOSED", "BB/II"].iter().any(|name| types.contains_key(*name)), "{types:?}");
    assert_lines_fit(state, &report["paths"]);
    let weld = page["settings"].as_array().unwrap().iter().find(|row| row["name"] == "--weld").unwrap();
    assert_eq!((&page["command"], &weld["value"]), (&"check".into(), &"exact".into()));
    assert_eq!(page["version"], env!("CARGO_PKG_VERSION"));
}

#[test]
fn page_far_from_the_origin_keeps_the_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut sheet = crumpled(7, 12);
    for place in &mut sheet.positions {
        *place = [place[0] + 1e6, place[1] - 3e6, place[2] + 2e6];
    }
    write(path, "far.obj", &sheet);
    command("check", path).args(["far.obj", "--html", "page.html"]).output().unwrap();
    let page = document(&path.join("page.html"));
    let mesh = read_mesh(path.join("far.obj")).unwrap();
    let found = positions(&page, &page["states"][0]);
    assert!(found.iter().zip(mesh.positions()).all(|(&a, &b)| distance(a, b) < 1e-6));
}

#[test]
fn page_of_a_fix_holds_both_states_and_what_was_done() {
    let folder = folder();
    let path = folder.path();
    let output = fix(&["square.obj", "spike.obj", "-o", "out.obj", "--json", "--html", "page.html"], path);
    assert_eq!(code(&output), 0, "{output:?}");
    let report = json(&output);
    let page = document(&path.join("page.html"));
    assert_eq!(page["report"], report);
    let [before, after] = [0, 1].map(|state| &page["states"][state]);
    assert_eq!((&before["name"], &after["name"]), (&"before".into(), &"after".into()));
    let [square, spike, out] = ["square.obj", "spike.obj", "out.obj"].map(|name| read_mesh(path.join(name)).unwrap());
    let input: Vec<_> = square.positions().iter().chain(spike.positions()).copied().collect();
    assert!(positions(&page, before).iter().zip(&input).all(|(&a, &b)| distance(a, b) < 1e-6));
    assert!(positions(&page, after).iter().zip(out.positions()).all(|(&a, &b)| distance(a, b) < 1e-6));
    assert_eq!(before["paths"].as_array().unwrap().len(), 1);
    assert_lines_fit(before, &before["paths"]);
    assert_eq!((&after["paths"], &after["points"]), (&serde_json::json!([]), &"".into()));

    let moved = singles(&page["change"]["moved_m"]);
    for ((moved, &a), &b) in moved.iter().zip(&input).zip(out.positions()) {
        assert!((moved - distance(a, b)).abs() < 1e-6, "{moved}");
    }
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let told = report["distortion"]["max_displacement_m"].as_f64().unwrap();
    assert!(told > 0.0 && (most(&moved) - told).abs() < 1e-6);
    let worst = singles(&page["change"]["stretch"]).iter().map(|ratio| ratio.max(1.0 / ratio)).fold(1.0, f64::max);
    let told = report["distortion"]["max_edge_stretch"].as_f64().unwrap();
    assert!((worst - told.max(1.0 / told)).abs() < 1e-6, "{worst} {told}");
}

#[test]
fn page_of_a_clean_fix_says_so_and_the_output_is_the_input() {
    let folder = folder();
    let path = folder.path();
    let output = fix(&["square.obj", "-o", "out.obj", "--json", "--html", "page.htm"], path);
    assert_eq!(code(&output), 0);
    let page = document(&path.join("page.htm"));
    assert_eq!(page["states"][0]["positions"], page["states"][1]["positions"]);
    assert!(singles(&page["change"]["moved_m"]).iter().all(|&moved| moved.abs() <= 0.0));
    assert_eq!(std::fs::read(path.join("square.obj")).unwrap(), std::fs::read(path.join("out.obj")).unwrap());
}

#[test]
fn page_of_a_blocked_tangle_names_pins_and_reasons() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("all.pin"), "0 1 2 3 4 5 6\n").unwrap();
    let arguments = ["square.obj", "spike.obj", "--pin", "all.pin", "-o", "out.obj", "--json", "--html", "page.html"];
    let output = fix(&arguments, path);
    assert_eq!(code(&output), 1, "{output:?}");
    let page = document(&path.join("page.html"));
    assert_eq!(page["mesh"]["pinned"], serde_json::json!([0, 1, 2, 3, 4, 5, 6]));
    assert_eq!(page["report"]["blocked"].as_array().unwrap().len(), 1);
    assert!(page["report"]["blocked"][0]["reason"].as_str().unwrap().contains("pinned"));
    assert_eq!(page["states"][1]["paths"].as_array().unwrap().len(), 1, "what is left is shown");
}

#[test]
fn page_of_an_outfit_holds_roles_and_what_is_on_the_wrong_side() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let outfit = Outfit::new(Pose { arms: [0.5, 0.5], legs: [0.15, 0.15] }, 24);
    let sheets: [(&str, &Sheet); 4] = [
        ("body.obj", &outfit.body),
        ("shirt.obj", &outfit.layers[0]),
        ("trousers.obj", &outfit.layers[1]),
        ("jacket.obj", &outfit.layers[2]),
    ];
    for (name, sheet) in sheets {
        write(path, name, sheet);
    }
    let arguments = ["shirt.obj", "trousers.obj", "jacket.obj", "--layers", "--body", "body.obj", "--json"];
    let output = command("check", path).args(arguments).args(["--html", "page.html"]).output().unwrap();
    let (report, page) = (json(&output), document(&path.join("page.html")));
    let parts = page["mesh"]["parts"].as_array().unwrap();
    let roles: Vec<&str> = parts.iter().map(|part| part["role"].as_str().unwrap()).collect();
    assert_eq!(roles, ["layer", "layer", "layer", "body"]);
    let all: usize = sheets.iter().map(|(_, sheet)| sheet.positions.len()).sum();
    assert_eq!(positions(&page, &page["states"][0]).len(), all, "bodies are shown as well");
    let wrong = page["states"][0]["wrong_sides"].as_array().unwrap();
    let told = |kind: &str| {
        let own = wrong.iter().find(|wrong| wrong["kind"] == kind);
        own.map_or(0, |wrong| wrong["vertices"].as_array().unwrap().len())
    };
    let behind: usize = report["layers"].as_array().unwrap().iter().map(|l| count(&l["num_vertices_behind"])).sum();
    assert!(behind > 0, "{}", report["layers"]);
    assert_eq!(told("layer"), behind);
    assert_eq!(told("body"), count(&report["num_vertices_inside_body"]));
    for wrong in wrong {
        let clusters = wrong["clusters"].as_array().unwrap();
        let sum: usize = clusters.iter().map(|cluster| count(&cluster["num_vertices"])).sum();
        assert_eq!(sum, wrong["vertices"].as_array().unwrap().len());
    }
}
