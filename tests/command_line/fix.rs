//! `untangled fix`: its report, pins and interruptions.

use std::{fs, process::Stdio};

use rustix::{
    fs::{CWD, FileType, Mode, mknodat},
    process::{Pid, Signal, kill_process},
};
use serde_json::Value;

use crate::mesh_folder::{SPIKE, SQUARE, code, command, complaint, fix, folder, is_progress, json, names};

/// Every field that scripts may rely on is there.
fn assert_fields(report: &Value) {
    assert_eq!(report["schema"], "untangled.fix/1");
    assert!(report["num_iterations"].is_u64() && report["seconds"].is_f64());
    for state in ["before", "after"] {
        let state = &report[state];
        assert!(state["num_edge_face_intersections"].is_u64() && state["num_face_pairs"].is_u64());
        assert!(state["path_pairs"].is_object());
    }
    assert!(report["before"]["num_face_pairs"].as_u64().unwrap() > 0);
    for field in ["max_displacement_m", "mean_displacement_m", "max_edge_stretch", "mean_edge_stretch"] {
        assert!(report["distortion"][field].is_f64(), "{field}");
    }
    for blocked in report["blocked"].as_array().unwrap() {
        assert!(blocked["pair_type"].is_string() && blocked["vertex"].is_u64() && blocked["length_m"].is_f64());
        assert!(!blocked["reason"].as_str().unwrap().is_empty());
    }
    let history = report["history"].as_array().unwrap();
    assert_eq!(history.len() as u64, report["num_iterations"].as_u64().unwrap());
    for iteration in history {
        assert!(iteration["num_edge_face_intersections"].is_u64() && iteration["path_length_m"].is_f64());
        assert!(iteration["method"].is_string());
    }
}

#[test]
fn fix_report_has_every_field_of_the_contract() {
    let folder = folder();
    let path = folder.path();
    for (inputs, out) in [(&["square.obj", "spike.obj"][..], "out.obj"), (&["tangled.glb"], "out.glb")] {
        let output = fix(&[inputs, &["-o", out, "--json", "--report", "report.json", "--overwrite"]].concat(), path);
        let report = json(&output);
        assert_eq!(fs::read(path.join("report.json")).unwrap(), output.stdout);
        assert_fields(&report);
        // What is said of the output is what another look at it finds.
        let clean = report["clean"].as_bool().unwrap();
        assert_eq!(code(&output), i32::from(!clean));
        assert_eq!(report["blocked"].as_array().unwrap().is_empty(), clean);
        let check = command("check", path).args([out, "--json"]).output().unwrap();
        assert_eq!(code(&check), i32::from(!clean));
        let check: Value = serde_json::from_slice(&check.stdout).unwrap();
        for field in ["num_edge_face_intersections", "num_face_pairs", "path_pairs"] {
            assert_eq!(check[field], report["after"][field], "{field}");
        }
    }
    // What is not geometry is as it was.
    let out = fs::read(path.join("out.glb")).unwrap();
    assert!(out.windows(25).any(|bytes| bytes == br#""extras": {"kept":  [1,2 "#), "{out:?}");
    let out = fs::read_to_string(path.join("out.obj")).unwrap();
    assert!(
        out.contains("usemtl red\r\ns 1\r\nf 1/1/1 2/2/1 3/3/1 4/4/1\r\nl 1 2\r\n# end\no spike\ng default\ns off\nv "),
        "{out}"
    );
    assert!(out.ends_with("usemtl blue\nf -3 -2 -1\n"), "{out}");
    let lines = fix(&["square.obj", "spike.obj", "-o", "lines.obj"], path);
    let lines = String::from_utf8(lines.stdout).unwrap();
    assert!(lines.starts_with("square.obj, spike.obj -> lines.obj\n"), "{lines}");
}

#[test]
fn fix_with_pins_keeps_pinned_vertices() {
    let folder = folder();
    let path = folder.path();
    let pin = |text: &str| fs::write(path.join("pins.txt"), text).unwrap();
    pin("# all but one\n0 1\t2 3# and the spike\r\n 4 5\n6\n");
    let run = ["square.obj", "spike.obj", "-o", "out", "--pin", "pins.txt", "--json"];
    fs::create_dir(path.join("out")).unwrap();
    let output = fix(&run, path);
    assert_eq!((code(&output), &json(&output)["clean"]), (1, &false.into()));
    assert_eq!(fs::read(path.join("out/square.obj")).unwrap(), SQUARE.as_bytes());
    assert_eq!(fs::read(path.join("out/spike.obj")).unwrap(), SPIKE.as_bytes());
    fs::remove_dir_all(path.join("out")).unwrap();
    fs::create_dir(path.join("out")).unwrap();
    for (text, expected) in [
        ("0\n\n1 x", "pins.txt:3: `x` where a vertex index is needed"),
        ("-1", "pins.txt:1: `-1` where a vertex index is needed"),
        ("1.0", "pins.txt:1: `1.0` where a vertex index is needed"),
        ("# 9\n3\n7", "pins.txt:3: vertex 7 does not exist, there are vertices 0 to 6"),
        ("99999999999999", "pins.txt:1: vertex 99999999999999 does not exist"),
    ] {
        pin(text);
        let text = complaint(&run, path);
        assert!(text.contains(expected), "{text}");
    }
    let text = complaint(&["square.obj", "-o", "a.obj", "--pin", "none.txt"], path);
    assert!(text.contains("none.txt: can't be read: "), "{text}");
}

#[test]
fn fix_when_interrupted_writes_nothing() {
    for signal in [Signal::INT, Signal::TERM] {
        let folder = folder();
        let path = folder.path();
        // A pipe as the input: when it is open at both ends, the process listens to signals and waits for the mesh,
        // which never comes.
        mknodat(CWD, path.join("pipe.obj"), FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        let before = names(path);
        let child = command("fix", path)
            .args(["pipe.obj", "spike.obj", "-o", "out.obj", "--report", "report.json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let pipe = fs::OpenOptions::new().write(true).open(path.join("pipe.obj")).unwrap();
        kill_process(Pid::from_child(&child), signal).unwrap();
        let output = child.wait_with_output().unwrap();
        drop(pipe);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        let said: Vec<&str> = said.lines().filter(|line| !is_progress(line)).collect();
        assert_eq!(said, ["untangled: interrupted; nothing was written"]);
        assert!(output.stdout.is_empty());
        assert_eq!(names(path), before);
    }
}

#[test]
fn fix_ends_at_its_limits_of_iterations_and_of_time() {
    let folder = folder();
    let path = folder.path();
    let inputs = ["square.obj", "spike.obj", "-o", "out.obj", "--json", "--overwrite"];
    let with = |more: &[&str]| fix(&[&inputs, more].concat(), path);
    let output = with(&["--max-iterations", "0"]);
    let report = json(&output);
    assert_eq!((code(&output), &report["num_iterations"], &report["clean"]), (1, &0.into(), &false.into()));
    let output = with(&["--time-limit", "1e-9"]);
    let report = json(&output);
    assert_eq!((code(&output), &report["time_limit_reached"], &report["clean"]), (1, &true.into(), &false.into()));
    let report = json(&with(&["--time-limit", "3600"]));
    assert_eq!((&report["time_limit_reached"], &report["clean"]), (&false.into(), &true.into()));
    for wrong in ["-1", "nan", "soon"] {
        let output = with(&["--time-limit", wrong]);
        assert_eq!(code(&output), 2, "{wrong}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("--time-limit"), "{output:?}");
    }
}
