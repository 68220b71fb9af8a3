//! The error bounds of floating-point filters, proven by Gappa: `lab/proofs/*.g`.
//!
//! Each script names the lines of code that it is about, which have to stand there to the letter: who changes one of
//! them finds the proof. Gappa is in Debian (`apt-get install gappa`); without it the scripts are not run, in words.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use super::tree;

/// Enough for bounds that differ in the square of the roundoff, and for numbers at the ends of the range.
const PRECISION_BITS: usize = 1500;

fn scripts() -> Vec<PathBuf> {
    let is_script =
        |path: &&PathBuf| path.starts_with("lab/proofs") && path.extension().is_some_and(|kind| kind == "g");
    tree::files().iter().filter(is_script).cloned().collect()
}

/// The lines of code that a script names, each with its file.
fn named_lines(script: &str) -> Vec<(&Path, &str)> {
    let mut file = Path::new("");
    let mut lines = Vec::new();
    for line in script.lines() {
        if let Some(name) = line.strip_prefix("# code ") {
            file = Path::new(name);
        } else if let Some(code) = line.strip_prefix("#   ") {
            lines.push((file, code));
        }
    }
    lines
}

#[test]
fn proofs_are_about_code_that_stands_there() {
    for script in scripts() {
        let text = fs::read_to_string(tree::root().join(&script)).unwrap();
        let lines = named_lines(&text);
        assert!(!lines.is_empty(), "{} names no code", script.display());
        for (file, line) in lines {
            let code = fs::read_to_string(tree::root().join(file))
                .unwrap_or_else(|error| panic!("{}: {}: {error}", script.display(), file.display()));
            let stands = code.lines().any(|stands| stands.trim() == line);
            assert!(stands, "{}: not in {}: {line}", script.display(), file.display());
        }
    }
}

#[test]
fn proofs_hold() {
    let gappa = |arguments: &[&str]| Command::new("gappa").args(arguments).current_dir(tree::root()).output();
    if gappa(&["--version"]).is_err() {
        println!("SKIPPED: there is no gappa on this machine (apt-get install gappa); no bound is proven again");
        return;
    }
    let scripts = scripts();
    assert!(scripts.len() >= 10, "{scripts:?}");
    for script in scripts {
        let name = script.to_str().unwrap();
        let output = gappa(&[&format!("-Eprecision={PRECISION_BITS}"), name]).unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{name}: {words}");
        // What is assumed is not proven.
        assert!(!words.contains("assumed"), "{name}: {words}");
        println!("{name}: holds");
    }
}
