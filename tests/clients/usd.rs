//! Shots in USD, beside usd-core: a stage that it wrote is repaired, and the layer over it read by it.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use untangled_testkit::{
    files::{formats::obj, repository},
    generate::Sheet,
    hosts::{python, run},
    process::untangled,
    shots::{FlapShot, pc2, usda_points},
};

/// Bytes of a PC2 file before its frames.
const HEADER_SIZE: usize = 32;

/// Runs the program of this test; none where there is no usd-core, and then it says what is skipped.
fn usd(arguments: &[&str], folder: &Path) -> Option<Output> {
    const SKIPPED: &str = "shots beside usd-core";
    let mut import = python::command(SKIPPED)?;
    if !import.args(["-c", "import pxr, numpy"]).output().is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {SKIPPED}: usd-core is not installed in this Python (TEST_PYTHON names another)");
        return None;
    }
    let mut program = python::command(SKIPPED)?;
    program.arg(repository().join("tests/clients/programs/usd_shot.py")).args(arguments).current_dir(folder);
    Some(run(&mut program))
}

fn fix(arguments: &[&str], folder: &Path) {
    let output = Command::new(untangled()).arg("fix").args(arguments).current_dir(folder).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
}

fn frames(path: &Path) -> Vec<u8> {
    fs::read(path).unwrap().split_off(HEADER_SIZE)
}

/// A folder with a cloth and its frames, in singles.
fn folder() -> tempfile::TempDir {
    let (folder, shot) = (tempfile::tempdir().unwrap(), FlapShot::small());
    let frames: Vec<Sheet> = (0..shot.num_frames).map(|frame| shot.cloth(frame)).collect();
    let mut first = frames[0].clone();
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    first.positions.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
    fs::write(folder.path().join("cloth.obj"), obj(&first, false)).unwrap();
    fs::write(folder.path().join("in.pc2"), pc2(&frames)).unwrap();
    folder
}

#[test]
fn layer_over_a_stage_of_usd_core_brings_about_the_certified_points_and_nothing_else() {
    let folder = folder();
    let path = folder.path();
    fix(&["cloth.obj", "--cache", "in.pc2", "-o", "out.pc2"], path);
    for shot in ["shot.usda", "shot.usdc"] {
        if usd(&["plain", shot, "cloth.obj", "in.pc2"], path).is_none() {
            return;
        }
        let source = fs::read(path.join(shot)).unwrap();
        fix(&[shot, "--prim", "/world/garment", "-o", "fix.usda", "--overwrite"], path);
        assert_eq!(fs::read(path.join(shot)).unwrap(), source);
        usd(&["points", "fix.usda", "/world/garment/cloth", "read.pc2"], path);
        assert!(frames(&path.join("read.pc2")) == frames(&path.join("out.pc2")), "{shot}");
        assert!(frames(&path.join("read.pc2")) != frames(&path.join("in.pc2")));
        usd(&["compare", shot, "fix.usda", "/world/garment/cloth"], path);
    }
    // Parts, joined as the manual says.
    fix(&["shot.usdc", "--prim", "/world", "-o", "a.usda", "--frames", "1..9"], path);
    fix(&["shot.usdc", "--prim", "/world", "-o", "b.usda", "--frames", "10..24"], path);
    usd(&["join", "joined.usda", "a.usda", "b.usda"], path);
    usd(&["points", "joined.usda", "/world/garment/cloth", "joined.pc2"], path);
    assert!(frames(&path.join("joined.pc2")) == frames(&path.join("out.pc2")));
}

#[test]
fn stage_that_usd_core_composes_is_corrected_in_the_space_of_its_mesh() {
    let folder = folder();
    let path = folder.path();
    for shot in ["set.usda", "set.usdc"] {
        if usd(&["composed", shot, "cloth.obj", "in.pc2"], path).is_none() {
            return;
        }
        fix(&[shot, "--prim", "/set", "-o", "fix.usda", "--overwrite"], path);
        usd(&["points", "fix.usda", "/set/garment/cloth", "read.pc2"], path);
        usd(&["points", shot, "/set/garment/cloth", "before.pc2"], path);
        let layer = fs::read_to_string(path.join("fix.usda")).unwrap();
        assert!(frames(&path.join("read.pc2")) == usda_points(&layer).concat(), "{shot}");
        let [before, after] = ["before.pc2", "read.pc2"].map(|name| frames(&path.join(name)));
        let num_moved = before.chunks(12).zip(after.chunks(12)).filter(|(a, b)| a != b).count();
        assert!(num_moved > 0 && num_moved < before.len() / 12, "{num_moved}");
        usd(&["compare", shot, "fix.usda", "/set/garment/cloth"], path);
        let check = Command::new(untangled()).args(["check", "fix.usda", "--prim", "/set"]).current_dir(path).output();
        assert_eq!(check.unwrap().status.code(), Some(0));
    }
}

#[test]
fn stage_that_refers_below_other_arcs_is_read_as_usd_core_reads_it() {
    let folder = folder();
    let path = folder.path();
    for shot in ["set.usda", "set.usdc"] {
        if usd(&["behind", shot, "cloth.obj", "in.pc2"], path).is_none() {
            return;
        }
        for prim in ["/set/above", "/set/variant"] {
            fix(&[shot, "--prim", prim, "-o", "fix.usda", "--overwrite", "--frames", "1..1"], path);
            let mesh = format!("{prim}/cloth");
            usd(&["points", shot, &mesh, "before.pc2"], path);
            // A clean frame far from all others: what is read and written is what usd-core reads.
            let layer = usda_points(&fs::read_to_string(path.join("fix.usda")).unwrap()).concat();
            assert!(layer.len() > 1000 && frames(&path.join("before.pc2")).starts_with(&layer), "{shot} {prim}");
        }
    }
}

#[test]
fn stage_of_which_usd_core_leaves_something_out_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for shot in ["shot.usda", "shot.usdc"] {
        if usd(&["missing", shot], folder.path()).is_none() {
            return;
        }
        for (name, words) in [
            ("reference", "prim /set/reference: refers to @"),
            ("payload", "prim /set/payload: refers to @"),
            ("cycle", "prim /set/cycle/below: refers to itself in a cycle: @"),
        ] {
            let stage = format!("{name}.usda");
            let mut check = Command::new(untangled());
            let output = check.args(["check", &stage, "--prim", "/set"]).current_dir(folder.path()).output().unwrap();
            let said = String::from_utf8(output.stderr.clone()).unwrap();
            assert!(output.status.code() == Some(2) && said.contains(words) && output.stdout.is_empty(), "{output:?}");
        }
        // What is there is checked.
        let mut check = Command::new(untangled());
        let output = check.args(["check", shot, "--prim", "/set/cloth"]).current_dir(folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    }
}
