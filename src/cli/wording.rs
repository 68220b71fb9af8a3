//! Words that reports, tables and pictures share.

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
};

use serde::Serialize;

use untangle::{analysis::Analysis, paths::PairType};

/// Number of path pairs by type; types that do not occur are left out.
pub(super) fn count_path_pairs(analysis: &Analysis) -> BTreeMap<PairType, usize> {
    let mut counts = BTreeMap::new();
    for pair in &analysis.paths.pairs {
        *counts.entry(pair.pair_type).or_default() += 1;
    }
    counts
}

/// The name of a type or method, as in JSON.
pub(super) fn name_of(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
}

/// A report as one line of JSON.
pub(super) fn json_line(report: &impl Serialize) -> String {
    let mut text =
        serde_json::to_string(report).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"));
    text.push('\n');
    text
}

/// How many vertices were welded.
pub(super) fn welded(count: usize) -> String {
    let (vertices, are) = (Counted(count, "vertex"), if count == 1 { "is" } else { "are" });
    format!("{vertices} {are} one with another in the same place (--weld off keeps them apart)")
}

/// How many coordinates count as zero.
pub(super) fn zeroed(count: usize) -> String {
    let counts = if count == 1 { "counts" } else { "count" };
    format!("{} below 2^-250 m {counts} as zero", Counted(count, "coordinate"))
}

/// `1 face`, `2 faces`; `1 vertex`, `2 vertices`.
pub(super) struct Counted(pub(super) usize, pub(super) &'static str);

impl Display for Counted {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self(count, noun) = self;
        match (count, noun.strip_suffix("ex")) {
            (1, _) => write!(f, "{count} {noun}"),
            (_, Some(stem)) => write!(f, "{count} {stem}ices"),
            _ => write!(f, "{count} {noun}s"),
        }
    }
}
