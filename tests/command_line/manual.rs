//! The manual keeps up with the code: its settings page names every key with its default, and the links of all pages
//! resolve.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::{
    fs,
    path::{Path, PathBuf},
};

use untangle::settings::Settings;
use untangled::config::Config;

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
    let optional = Settings { thickness_m: Some(1.0), deadline_us: Some(1), ..Settings::default() };
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
