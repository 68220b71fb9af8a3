//! Layers over each other, and over a body.

use untangled_checker::{crossings, near_pairs, vertices_behind, vertices_inside};
use untangled_mesh_io::read_mesh;
use untangled_testkit::generate::{
    Sheet,
    outfits::{GARMENTS, Outfit, Pose},
};

use super::{check, write};
use crate::mesh_folder::{code, fix, json};

/// A body, and a shirt, a vest and a jacket that go through each other, or a jacket that is all below the vest.
fn write_outfit(folder: &std::path::Path, around: u32) {
    let mut body = Sheet::default();
    body.add_capsule(0.3, 0.7, 24, 24);
    write(folder, "body.obj", &body);
    let garment = |name: &str, radius: f64, heights: [f64; 2], around: u32, wave: f64| {
        let mut sheet = Sheet::default();
        sheet.add_tube(radius, heights, [around, around / 2], |angle, height| {
            let out = wave * (3.0 * angle + 4.0 * height).sin();
            [out * angle.cos(), out * angle.sin(), 0.0]
        });
        write(folder, name, &sheet);
    };
    garment("shirt.obj", 0.33, [-0.55, 0.6], around, 0.02);
    garment("vest.obj", 0.35, [-0.6, 0.57], around + 4, 0.01);
    garment("jacket.obj", 0.37, [-0.5, 0.65], around + 7, 0.05);
    garment("below.obj", 0.31, [-0.5, 0.65], around + 7, 0.0);
}

/// Vertices of layers that are behind one of those before them in the list, by the judge.
pub(super) fn num_behind(folder: &std::path::Path, files: &[&str], positions: &[[f64; 3]]) -> usize {
    let mut inner: Vec<Vec<[u32; 3]>> = Vec::new();
    let (mut first, mut num_behind) = (0, 0);
    for file in files {
        let mesh = read_mesh(folder.join(file)).unwrap();
        let end = first + u32::try_from(mesh.positions().len()).unwrap();
        for layer in &inner {
            num_behind += vertices_behind(positions, first..end, layer, 0.1).unwrap().len();
        }
        inner.push(mesh.faces().iter().map(|face| face.map(|corner| corner + first)).collect());
        first = end;
    }
    num_behind
}

#[test]
fn fix_of_layers_through_each_other_and_of_layers_in_the_wrong_order_puts_them_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for around in [24, 40] {
        write_outfit(path, around);
        for (files, body) in [
            (&["vest.obj", "jacket.obj"][..], false),
            (&["vest.obj", "below.obj"], false),
            (&["shirt.obj", "vest.obj", "jacket.obj"], true),
            (&["shirt.obj", "vest.obj", "below.obj"], true),
        ] {
            let mut arguments = files.to_vec();
            arguments.extend(["--layers", "-o", "out.obj", "--json", "--overwrite"]);
            arguments.extend(["--body", "body.obj"].iter().filter(|_| body));
            let output = fix(&arguments, path);
            let report = json(&output);
            assert_eq!(code(&output), 0, "{files:?}: {}", report["after"]);
            let layers = report["layers"].as_array().unwrap();
            assert_eq!(layers.len(), files.len());
            let counts = |when: &str| -> Vec<u64> {
                layers.iter().map(|layer| layer["num_vertices_behind"][when].as_u64().unwrap()).collect()
            };
            assert!(counts("before").last() > Some(&20), "{layers:?}");
            assert!(counts("after").iter().all(|&count| count == 0), "{layers:?}");
            let out = read_mesh(path.join("out.obj")).unwrap();
            assert!(crossings(out.positions(), out.faces()).unwrap().pairs.is_empty());
            if body {
                let (mut positions, body) = (out.positions().to_vec(), read_mesh(path.join("body.obj")).unwrap());
                let num = u32::try_from(positions.len()).unwrap();
                positions.extend(body.positions());
                let faces: Vec<[u32; 3]> = body.faces().iter().map(|face| face.map(|corner| corner + num)).collect();
                assert_eq!(vertices_inside(&positions, 0..num, &faces).unwrap(), [0_u32; 0]);
            }
            // Their faces point outwards.
            let before: Vec<[f64; 3]> =
                files.iter().flat_map(|file| read_mesh(path.join(file)).unwrap().positions().to_vec()).collect();
            assert!(num_behind(path, files, &before) > 20, "{files:?}");
            assert_eq!(num_behind(path, files, out.positions()), 0, "{files:?}");
            for number in ["num_vertices_behind", "num_vertices_behind_single"] {
                let judged = |when: &str| report[when]["certificate"][number].as_u64().unwrap();
                assert!(judged("before") > 20 && judged("after") == 0, "{files:?}: {number}");
            }
        }
    }
}

#[test]
fn check_with_layers_counts_vertices_behind_and_is_not_clean_with_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_outfit(path, 24);
    let (code, report) = check(&["vest.obj", "below.obj", "--layers"], path);
    assert_eq!((code, &report["num_face_pairs"]), (1, &0.into()));
    assert_eq!(report["layers"][0], serde_json::json!({"file": "vest.obj", "num_vertices_behind": 0}));
    assert!(report["layers"][1]["num_vertices_behind"].as_u64() > Some(300), "{}", report["layers"]);
    assert_eq!(report["certificate"]["num_vertices_behind"], report["layers"][1]["num_vertices_behind"]);
    // The other way round they are in order.
    let (code, report) = check(&["below.obj", "vest.obj", "--layers"], path);
    assert_eq!((code, &report["layers"][1]["num_vertices_behind"]), (0, &0.into()));
    let (code, report) = check(&["vest.obj", "below.obj"], path);
    assert_eq!((code, &report["layers"]), (0, &().into()));
    assert_eq!(report["certificate"]["num_vertices_behind"], serde_json::Value::Null);
}

#[test]
fn fix_of_outfits_of_four_layers_on_a_body_in_poses_ends_clean_in_order_and_with_the_gap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let files = GARMENTS.map(|name| format!("{name}.obj"));
    let files = files.each_ref().map(String::as_str);
    // All of them are in docs/results/outfits.md.
    for (pose, around) in [(Pose::ALL[0], 28), (Pose::ALL[2], 40)] {
        let arms = pose.arms;
        let outfit = Outfit::new(pose, around);
        write(path, "body.obj", &outfit.body);
        files.iter().zip(&outfit.layers).for_each(|(file, layer)| write(path, file, layer));
        let before: Vec<[f64; 3]> = outfit.layers.iter().flat_map(|layer| layer.positions.clone()).collect();
        assert!(num_behind(path, &files, &before) > 20);
        let mut arguments = files.to_vec();
        arguments.extend([
            "--layers",
            "--body",
            "body.obj",
            "--gap",
            "0.002",
            "-o",
            "out.obj",
            "--json",
            "--overwrite",
        ]);
        let output = fix(&arguments, path);
        let report = json(&output);
        assert_eq!(code(&output), 0, "{arms:?}: {} {} {}", report["after"], report["gap"], report["blocked"]);
        let out = read_mesh(path.join("out.obj")).unwrap();
        assert_eq!(num_behind(path, &files, out.positions()), 0, "{arms:?}");
        let (mut positions, mut faces) = (out.positions().to_vec(), out.faces().to_vec());
        let (num, first_body) = (u32::try_from(positions.len()).unwrap(), faces.len());
        positions.extend_from_slice(&outfit.body.positions);
        faces.extend(outfit.body.faces.iter().map(|face| face.map(|corner| corner + num)));
        assert_eq!(vertices_inside(&positions, 0..num, &faces[first_body..]).unwrap(), [0_u32; 0]);
        assert_eq!(near_pairs(&positions, &faces, first_body, 0.002).unwrap().total(), 0, "{arms:?}");
    }
}

#[test]
fn fix_puts_garments_that_intersect_in_the_order_in_which_most_of_each_lies() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let files = GARMENTS.map(|name| format!("{name}.obj"));
    let files = files.each_ref().map(String::as_str);
    let outfit = Outfit::new(Pose::ALL[0], 28);
    write(path, "body.obj", &outfit.body);
    files.iter().zip(&outfit.layers).for_each(|(file, layer)| write(path, file, layer));
    let mut moved = Vec::new();
    for options in [&["--body", "body.obj"][..], &[], &["--body", "body.obj", "--layers"]] {
        let output = fix(&[&files[..], &["-o", "out.obj", "--json", "--overwrite"], options].concat(), path);
        let report = json(&output);
        assert_eq!(code(&output), 0, "{options:?}: {}", report["after"]);
        let out = read_mesh(path.join("out.obj")).unwrap();
        assert_eq!(num_behind(path, &files, out.positions()), 0, "{options:?}");
        moved.push(report["distortion"]["mean_displacement_m"].as_f64().unwrap());
        // Of each pair that intersects the inner one comes first in the list.
        let orders = report["implied_order"].as_array().map_or(&[][..], Vec::as_slice);
        assert_eq!(orders.is_empty(), options.contains(&"--layers"), "{orders:?}");
        // A jacket of three pieces over a shirt of three is said once.
        assert!(orders.iter().enumerate().all(|(k, order)| !orders[..k].contains(order)), "{orders:?}");
        let place = |name: &serde_json::Value| files.iter().position(|file| name.as_str().unwrap().starts_with(file));
        assert!(
            orders.iter().all(|order| place(&order["inner"]).unwrap() < place(&order["outer"]).unwrap()),
            "{orders:?}"
        );
    }
    // As far as with the order given.
    assert!(moved.iter().all(|mean_m| *mean_m < 1.1 * moved[2]), "{moved:?}");
}
