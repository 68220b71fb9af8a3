//! The page in a real browser, and its script built again.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use untangled_testkit::{files::repository, generate::waves::crumpled};

use super::write;
use crate::mesh_folder::{code, command, fix, folder};

/// Runs a script of `report/`, where Node and the packages of the lock file are there; else says what is skipped.
pub(crate) fn node(skipped: &str, arguments: &[&str]) -> Option<Output> {
    let report = repository().join("report");
    if !Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {skipped}: there is no Node on this machine");
        return None;
    }
    if !report.join("node_modules/playwright-core").is_dir() || !report.join("node_modules/three").is_dir() {
        eprintln!("SKIPPED: {skipped}: report/node_modules is not there (npm ci in report)");
        return None;
    }
    Some(Command::new("node").args(arguments).current_dir(report).output().unwrap())
}

/// Drives a page, where there is a browser: `report/drive/drive.mjs` says what it looks at. Gives back what it saw.
fn drive(page: &Path) -> Option<Value> {
    drive_by("a page in a browser", &["drive/drive.mjs", page.to_str().unwrap()])
}

/// Drives something by a script of `report/`, where there is a browser. Gives back what it saw.
pub(crate) fn drive_by(skipped: &str, arguments: &[&str]) -> Option<Value> {
    let output = node(skipped, arguments)?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.code() == Some(77) {
        eprintln!("SKIPPED: {skipped}: {}", text.trim_end());
        return None;
    }
    // The words of the failure stand first and last, whichever part of a log is kept.
    let head = text.lines().last().unwrap_or_default();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{head}\n{arguments:?}\n{errors}\n{text}");
    Some(serde_json::from_str(text.lines().last().unwrap()).unwrap())
}

#[test]
fn built_script_and_style_are_what_their_sources_give() {
    let folder = tempfile::tempdir().unwrap();
    let Some(output) = node("building the pages' scripts again", &["build.mjs", folder.path().to_str().unwrap()])
    else {
        return;
    };
    assert!(output.status.success(), "{output:?}");
    for name in ["page.js", "page.css", "watch.js", "watch.css"] {
        let [built, kept] = [folder.path().join(name), repository().join("report/built").join(name)];
        let is_same = fs::read(built).unwrap() == fs::read(kept).unwrap();
        assert!(is_same, "report/built/{name} is not what its sources give: npm run build in report");
    }
}

#[test]
fn colours_of_both_pages_stay_apart_for_the_colour_blind() {
    let Some(output) = node("colours as the colour-blind see them", &["drive/colours.mjs"]) else { return };
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("types of paths: nearest of one shape: "), "{text}");
}

#[test]
fn page_of_a_check_works_in_a_browser() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "cloth.obj", &crumpled(7, 40));
    let output = command("check", path).args(["cloth.obj", "--html", "page.html"]).output().unwrap();
    assert_eq!(code(&output), 1);
    let Some(seen) = drive(&path.join("page.html")) else { return };
    assert!(seen["pixels"].as_object().unwrap().len() > 2, "{seen}");
}

#[test]
fn page_of_a_fix_works_in_a_browser() {
    let folder = folder();
    let path = folder.path();
    // One that is blocked, and one that is not.
    fs::write(path.join("all.pin"), "0 1 2 3 4 5 6\n").unwrap();
    let blocked = ["square.obj", "spike.obj", "--pin", "all.pin", "-o", "b.obj", "--html", "blocked.html"];
    assert_eq!(code(&fix(&blocked, path)), 1);
    assert_eq!(code(&fix(&["square.obj", "spike.obj", "-o", "out.obj", "--html", "page.html"], path)), 0);
    for page in ["blocked.html", "page.html"] {
        let Some(seen) = drive(&path.join(page)) else { return };
        assert_eq!(seen["pixels"].as_object().unwrap().len(), 1, "{page}: {seen}");
    }
}

#[test]
fn page_of_a_shot_works_in_a_browser() {
    let folder = crate::sequence::folder();
    let path = folder.path();
    let fixing = ["fix", "cloth.obj", "--cache", "in.pc2", "-o", "out.pc2", "--html", "page.html", "--frames", "0..9"];
    assert_eq!(code(&crate::sequence::run(&fixing, path)), 0);
    drive(&path.join("page.html"));
}
