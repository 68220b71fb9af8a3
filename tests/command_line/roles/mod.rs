//! `--body` and `--layers` of `untangled check` and `untangled fix`.

mod bodies;
mod flat_layers;
mod known_cases;
mod layers;

use std::{fs, path::Path};

use serde_json::Value;
use untangled_checker::{crossings, vertices_inside};
use untangled_mesh_io::read_mesh;
use untangled_testkit::{files::formats::obj, generate::Sheet};

use crate::mesh_folder::{code, command, fix, json};

fn write(folder: &Path, name: &str, sheet: &Sheet) {
    fs::write(folder.join(name), obj(sheet, false)).unwrap();
}

/// Checks files, and gives back the exit code and the report.
fn check(arguments: &[&str], folder: &Path) -> (i32, Value) {
    let output = command("check", folder).args(arguments).arg("--json").output().unwrap();
    (code(&output), json(&output))
}

/// Fixes a cloth beside bodies, and judges what was written: nothing crosses, no vertex is inside, no edge is stretched
/// far, and bodies stay as they were.
fn fix_and_judge(cloth: &str, bodies: &[&str], folder: &Path) -> Value {
    let read_bodies = || bodies.iter().map(|body| fs::read(folder.join(body)).unwrap()).collect::<Vec<_>>();
    let before = read_bodies();
    let mut arguments = vec![cloth, "-o", "out.obj", "--json", "--overwrite"];
    arguments.extend(bodies.iter().flat_map(|body| ["--body", body]));
    let output = fix(&arguments, folder);
    let report = json(&output);
    assert_eq!(code(&output), 0, "{cloth}: {}", report["after"]);
    assert_eq!(read_bodies(), before);
    let [input, out] = [cloth, "out.obj"].map(|name| read_mesh(folder.join(name)).unwrap());
    assert_eq!(out.faces().len(), input.faces().len());
    let (mut positions, mut faces) = (out.positions().to_vec(), out.faces().to_vec());
    let num = [u32::try_from(positions.len()).unwrap(), u32::try_from(faces.len()).unwrap()];
    for body in bodies {
        let body = read_mesh(folder.join(body)).unwrap();
        let first = u32::try_from(positions.len()).unwrap();
        positions.extend_from_slice(body.positions());
        faces.extend(body.faces().iter().map(|face| face.map(|corner| corner + first)));
    }
    assert_eq!(vertices_inside(&positions, 0..num[0], &faces[num[1] as usize..]).unwrap(), [0_u32; 0]);
    let found = crossings(&positions, &faces).unwrap().pairs;
    assert!(found.iter().all(|pair| pair[0] >= num[1]), "{cloth}: {found:?}");
    for &[a, b, c] in input.faces() {
        for [a, b] in [[a, b], [b, c], [c, a]].map(|ends| ends.map(|end| end as usize)) {
            let length = |at: &[[f64; 3]]| (0..3).map(|axis| (at[b][axis] - at[a][axis]).powi(2)).sum::<f64>().sqrt();
            let ratio = length(out.positions()) / length(input.positions());
            assert!((0.5..=1.6).contains(&ratio), "{cloth}: an edge is {ratio} times as long");
        }
    }
    report
}
