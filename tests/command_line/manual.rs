//! The manual keeps up with the code: its settings page names every key with its default, and the links of all pages
//! resolve.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use untangle::settings::Settings;
use untangled::config::Config;

use crate::mesh_folder::command;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Names and values of all keys, as TOML writes them.
fn keys(prefix: &str, table: &toml::Table) -> Vec<(String, toml::Value)> {
    table
        .iter()
        .flat_map(|(name, value)| match value {
            toml::Value::Table(section) => keys(&format!("{prefix}{name}."), section),
            _ => vec![(format!("{prefix}{name}"), value.clone())],
        })
        .collect()
}

#[test]
fn settings_page_names_every_key_with_its_default() {
    let page = fs::read_to_string(root().join("docs/manual/settings.md")).unwrap();
    let optional = Settings {
        thickness_m: Some(1.0),
        deadline_us: Some(1),
        max_face_pairs: Some(1),
        max_tested_pairs: Some(1),
        repair_deadline_us: Some(1),
        ..Settings::default()
    };
    let all = toml::Table::try_from(Config { settings: optional, ..Config::default() }).unwrap();
    let defaults = toml::Table::try_from(Config::default()).unwrap();
    let defaults = keys("", &defaults);
    for (key, _) in keys("", &all) {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{key}` |")));
        let row = row.unwrap_or_else(|| panic!("docs/manual/settings.md has no row for `{key}`"));
        if let Some((_, default)) = defaults.iter().find(|(name, _)| *name == key) {
            assert!(row.contains(&format!("| `{default}` |")), "`{key}` is {default} by default; the page says: {row}");
        }
    }
    for line in page.lines().filter(|line| line.starts_with("| `settings.")) {
        let key = line.split('`').nth(1).unwrap();
        assert!(keys("", &all).iter().any(|(name, _)| name == key), "there is no key `{key}`");
    }
}

/// Whether a session may choose this value of a setting.
fn is_accepted(name: &str, value: &serde_json::Value) -> bool {
    if name == "quality" {
        return serde_json::from_value::<untangle::settings::Quality>(value.clone()).is_ok();
    }
    let chosen = serde_json::json!({ name: value });
    serde_json::from_value::<Settings>(chosen).is_ok_and(|settings| settings.validate().is_ok())
}

/// Values at the ends of a range, and values beyond them, as the protocol's table says them.
fn ends(range: &str) -> (Vec<serde_json::Value>, Vec<serde_json::Value>) {
    let number = |text: &str| match text.trim_matches('`') {
        "min_centres" => i64::try_from(Settings::default().min_centres).unwrap(),
        "max_centres" => i64::try_from(Settings::default().max_centres).unwrap(),
        text => text.parse().unwrap(),
    };
    if let Some((least, most)) = range.split_once(" to ") {
        let (least, most) = (number(least), number(most));
        return (vec![least.into(), most.into()], vec![(least - 1).into(), (most + 1).into()]);
    }
    if let Some(least) = range.strip_suffix(" or more") {
        return (vec![number(least).into(), 1_000_000.into()], vec![(number(least) - 1).into()]);
    }
    let words = range.split('`').skip(1).step_by(2).map(serde_json::Value::from).collect();
    (words, vec!["no such word".into()])
}

#[test]
fn protocol_names_every_setting_with_its_type_and_range() {
    let page = fs::read_to_string(root().join("proto/PROTOCOL.md")).unwrap();
    let section = page.split("\n## ").find(|section| section.starts_with("Settings\n")).unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let rows: Vec<Vec<&str>> = rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect();
    // What is left out stands as null.
    let all = serde_json::to_value(Settings::default()).unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row[0].trim_matches('`')).collect();
    for name in all.as_object().unwrap().keys() {
        assert!(names.contains(&name.as_str()), "the table has no row for `{name}`");
    }
    assert_eq!(names.len(), all.as_object().unwrap().len() + 1, "{names:?}");
    for (name, row) in names.iter().zip(&rows) {
        let (mut good, mut bad) = match row[1] {
            "bool" => (vec![true.into()], vec![1.into()]),
            _ => ends(row[2]),
        };
        let null = if row[1].ends_with("or null") { &mut good } else { &mut bad };
        null.push(serde_json::Value::Null);
        if row[1].starts_with("integer") {
            bad.push(7.5.into());
        }
        if row[1].starts_with("number") {
            good.push(7.5.into());
        }
        assert!(good.iter().all(|value| is_accepted(name, value)), "`{name}` refuses one of {good:?}");
        assert!(bad.iter().all(|value| !is_accepted(name, value)), "`{name}` takes one of {bad:?}");
    }
}

/// All Markdown pages below a folder.
fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

/// All Rust files below a folder, but for what was built.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            rust_files(&path, found);
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
}

#[test]
fn security_page_lists_every_file_with_unsafe_blocks_and_their_number() {
    let page = fs::read_to_string(root().join("SECURITY.md")).unwrap();
    let section = page.split("\n## ").find(|section| section.starts_with("Unsafe code")).unwrap();
    let rows: Vec<Vec<&str>> =
        section.lines().filter(|line| line.contains('`')).map(|l| l.split('|').collect()).collect();
    let counts = rows.iter().filter_map(|row| row.get(2)).flat_map(|cell| cell.split(','));
    let listed: usize = counts.filter_map(|count| count.trim().parse::<usize>().ok()).sum();
    let mut files = Vec::new();
    rust_files(&root(), &mut files);
    let mut found = 0;
    // In two parts, so that this file has none.
    let [block, implementation] = ["{", "impl"].map(|what| ["unsafe", what].join(" "));
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        let blocks = text.lines().filter(|line| line.contains(&block) || line.contains(&implementation)).count();
        let mut names = path.iter().rev().map(|name| name.to_string_lossy());
        let file = names.next().unwrap();
        let folder = names.next().unwrap();
        let is_listed = section.contains(&format!("{file}`")) || section.contains(&format!("`{folder}`"));
        assert!(blocks == 0 || is_listed, "SECURITY.md does not name {}", path.display());
        found += blocks;
    }
    assert_eq!(listed, found, "blocks of unsafe in SECURITY.md, and in the code");
}

/// The lines of a page outside of code blocks, code spans emptied.
fn prose(page: &str) -> Vec<String> {
    let mut in_code = false;
    let mut lines = Vec::new();
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        } else if !in_code {
            lines.push(line.split('`').step_by(2).collect::<Vec<_>>().join("`"));
        }
    }
    lines
}

/// What links call the headings of a page.
fn anchors(page: &str) -> Vec<String> {
    let mut in_code = false;
    let headings = page.lines().filter(|line| {
        in_code ^= line.trim_start().starts_with("```");
        !in_code && line.starts_with('#')
    });
    let slug = |heading: &str| {
        let text = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(slug).collect()
}

#[test]
fn links_of_all_pages_resolve() {
    let mut found = Vec::new();
    for folder in ["docs", "clients", "proto"] {
        pages(&root().join(folder), &mut found);
    }
    let at_top = fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().path());
    found.extend(at_top.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    let mut broken = Vec::new();
    for path in &found {
        let page = fs::read_to_string(path).unwrap();
        for line in prose(&page) {
            for link in line.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
                if link.starts_with("http") {
                    continue;
                }
                let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                let target = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
                let has_anchor = || anchors(&fs::read_to_string(&target).unwrap()).iter().any(|known| known == anchor);
                if !target.exists() || !(anchor.is_empty() || has_anchor()) {
                    broken.push(format!("{}: {link}", path.strip_prefix(root()).unwrap().display()));
                }
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn config_with_a_file_prints_what_the_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("mine.toml"), "domain = \"atelier\"\n[settings]\npath_rings = 5\n").unwrap();
    let run = |file: &str| command("config", path).args(["--config", file]).output().unwrap();
    let printed = String::from_utf8(run("mine.toml").stdout).unwrap();
    assert!(printed.contains("domain = \"atelier\"") && printed.contains("path_rings = 5"), "{printed}");
    let output = run("none.toml");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("none.toml"));
}

/// Commands that people see in `--help`.
const COMMANDS: [&str; 10] =
    ["serve", "status", "watch", "config", "check", "fix", "join", "demo", "completions", "man"];

#[test]
fn manual_pages_name_every_command_and_its_flags() {
    let folder = tempfile::tempdir().unwrap();
    let output = command("man", folder.path()).arg(".").output().unwrap();
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    let page = |name: &str| fs::read_to_string(folder.path().join(format!("{name}.1"))).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1 + COMMANDS.len());
    for name in COMMANDS {
        assert!(page("untangled").contains(&format!("untangled\\-{name}(1)")), "{name}");
        assert!(page(&format!("untangled-{name}")).contains("SYNOPSIS"), "{name}");
    }
    assert!(page("untangled-fix").contains("\\-\\-body"));
    let output = command("man", folder.path()).arg("none").output().unwrap();
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint.starts_with("untangled: none/untangled.1: "), "{complaint}");
}

#[test]
fn completions_of_every_shell_know_the_commands_and_flags() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let output = command("completions", &root()).arg(shell).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{shell}");
        let script = String::from_utf8(output.stdout).unwrap();
        for word in COMMANDS.iter().chain(&["gap-for", "weld"]) {
            assert!(script.contains(word), "{shell} {word}");
        }
    }
    assert_eq!(command("completions", &root()).arg("none").output().unwrap().status.code(), Some(2));
}
