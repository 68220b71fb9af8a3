//! The rules of the house, held over the sources of all crates: floors, circles of files, sizes of rooms and lines.
//!
//! Reads text and syntax; nothing is built. `cargo test -p untangled-testkit --test house -- --nocapture` prints what
//! it counted.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

mod graph;
mod modules;
mod names;
mod processors;
mod proofs;
mod tree;

use std::{collections::BTreeMap, path::Path};

use graph::{Graph, circles};
use modules::Package;

/// Sources, documents and everything else that people read.
const READ_BY_PEOPLE: [&str; 17] =
    ["rs", "md", "py", "pyi", "c", "h", "cpp", "hpp", "toml", "cmake", "yml", "sh", "service", "run", "ts", "mjs", "g"];
const MAX_COLUMNS: usize = 120;
const MAX_FILES_OF_A_FOLDER: usize = 10;

fn architecture() -> String {
    std::fs::read_to_string(tree::root().join("ARCHITECTURE.md")).unwrap()
}

/// The names in the first column of the table below a heading, in its order.
fn rows(document: &str, heading: &str) -> Vec<String> {
    let section = document.split(&format!("\n## {heading}\n")).nth(1).unwrap_or_else(|| panic!("no section {heading}"));
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| row.split('`').next().unwrap().to_owned()).collect()
}

#[test]
fn crates_depend_on_those_above_them_in_the_table_only() {
    let order = rows(&architecture(), "Crates");
    let place = |name: &str| order.iter().position(|row| row == name);
    let packages = modules::packages();
    for package in &packages {
        let own = place(&package.name).unwrap_or_else(|| panic!("`{}` is not in the table of crates", package.name));
        for dependency in &package.dependencies {
            let Some(other) = place(dependency) else { continue };
            assert!(other < own, "`{}` depends on `{dependency}`, which is not above it in the table", package.name);
        }
    }
    println!("{} crates, no dependency upwards", packages.len());
}

#[test]
fn modules_of_the_library_use_those_above_them_in_the_table_only() {
    let order = rows(&architecture(), "Floors of the library");
    let packages = modules::packages();
    let library = packages.iter().find(|package| package.name == "untangle").unwrap();
    let graph = Graph::of(library);
    let mut count = 0;
    for (from, to) in graph.edges() {
        let [own, other] = [from, to].map(|file| library.top_module(file));
        if own == other || own == "lib" {
            continue;
        }
        let [own_place, other_place] = [&own, &other].map(|name| {
            order.iter().position(|row| row == name).unwrap_or_else(|| panic!("`{name}` is not in the table of floors"))
        });
        assert!(other_place < own_place, "{}: uses `{other}`, which is not above `{own}`", from.display());
        count += 1;
    }
    println!("{count} uses between modules of the library, none upwards");
}

#[test]
fn files_of_a_crate_form_no_circle() {
    let mut found = Vec::new();
    for package in modules::packages() {
        for graph in Package::programs(&package).iter().map(Graph::of) {
            found.extend(circles(&graph));
        }
    }
    assert!(found.is_empty(), "circles of files:\n{}", found.join("\n"));
    println!("no circle of files");
}

#[test]
fn folders_hold_at_most_ten_files() {
    let mut sizes: BTreeMap<&Path, usize> = BTreeMap::new();
    let files = tree::files();
    for file in files.iter().filter(|file| file.extension().is_some_and(|kind| kind == "rs")) {
        *sizes.entry(file.parent().unwrap()).or_default() += 1;
    }
    for (folder, size) in &sizes {
        println!("{size:3} {}", folder.display());
    }
    let full: Vec<_> = sizes.iter().filter(|&(_, &size)| size > MAX_FILES_OF_A_FOLDER).collect();
    assert!(full.is_empty(), "folders with more than {MAX_FILES_OF_A_FOLDER} files: {full:?}");
}

#[test]
fn lines_have_at_most_120_columns() {
    let mut long = Vec::new();
    for file in tree::files() {
        let kind = file.extension().and_then(|kind| kind.to_str()).unwrap_or("run");
        // Tables are as wide as their cells.
        let is_table = |line: &str| file.extension().is_some_and(|kind| kind == "md") && line.starts_with('|');
        if !READ_BY_PEOPLE.contains(&kind) || file.starts_with("LICENSE-MIT") {
            continue;
        }
        let Ok(text) = std::fs::read_to_string(tree::root().join(&file)) else { continue };
        for (number, line) in text.lines().enumerate() {
            if line.chars().count() > MAX_COLUMNS && !is_table(line) {
                long.push(format!("{}:{}", file.display(), number + 1));
            }
        }
    }
    assert!(long.is_empty(), "{} lines of more than {MAX_COLUMNS} columns:\n{}", long.len(), long.join("\n"));
}

#[test]
fn sources_include_no_file_by_path() {
    let attribute = concat!("#[", "path");
    for file in tree::files().iter().filter(|file| file.extension().is_some_and(|kind| kind == "rs")) {
        let text = std::fs::read_to_string(tree::root().join(file)).unwrap();
        assert!(!text.contains(attribute), "{} includes a file by its path", file.display());
    }
}
