//! What is said of a frame to people: what is in it, and what other readers of it find. Lines are read as JSON, since
//! those of a run that was ended come from its journal.

use serde::Deserialize;
use serde_json::Value;

use crate::cli::{
    certificate::Certificate,
    wording::{Counted, zeroed},
};

/// A kind of fault of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fault {
    pub(super) count: usize,
    noun: &'static str,
    place: &'static str,
}

impl Fault {
    /// How many there are, in words.
    pub(super) fn words(&self) -> String {
        format!("{}{}", Counted(self.count, self.noun), self.place)
    }
}

/// All kinds of faults of a state, by its counts and by its primitives nearer than the gap.
pub(super) fn faults(counts: &Value, num_below: &Value) -> [Fault; 4] {
    let behind = counts["layers"].as_array().into_iter().flatten().map(|layer| number(&layer["num_vertices_behind"]));
    [
        (number(&counts["num_face_pairs"]), "intersecting face pair", ""),
        (number(&counts["num_vertices_inside_body"]), "vertex", " inside of a body"),
        (behind.sum(), "vertex", " behind an inner layer"),
        (number(num_below), "primitive pair", " nearer than the gap"),
    ]
    .map(|(count, noun, place)| Fault { count, noun, place })
}

/// Lines for what other readers find in a state beyond its faults, below a line that says whose they are; nothing where
/// they find no more.
pub(super) fn by_readers(whose: &str, counts: &Value, gap: &Value) -> String {
    let certificate = Certificate::deserialize(&counts["certificate"]).unwrap_or_default();
    let mut lines = certificate.to_string();
    let num_single = number(&gap["certificate"]["num_pairs_below_single"]);
    if num_single > number(&gap["num_pairs_below"]) {
        let pairs = Counted(num_single, "primitive pair");
        lines.push_str(&format!("  rounded to single precision: {pairs} nearer than the gap\n"));
    }
    if lines.is_empty() {
        return lines;
    }
    let lines: String = lines.lines().map(|line| format!("    {line}\n")).collect();
    format!("    {whose}:\n{lines}")
}

/// The line for coordinates of all frames that count as zero; nothing without any.
pub(super) fn zeroed_line(count: usize) -> String {
    if count == 0 { String::new() } else { format!("  {}\n", zeroed(count)) }
}

/// A count in a line; 0 where there is none.
pub(super) fn number(value: &Value) -> usize {
    value.as_u64().and_then(|value| usize::try_from(value).ok()).unwrap_or(0)
}
