//! What `untangled fix` reports: one document, as JSON or as lines for people.

mod distortion;

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
};

use serde::Serialize;

use untangle::{
    analysis::Analysis,
    paths::PairType,
    relax::{BlockedPath, Iteration, STRETCH_LIMIT},
};

use crate::cli::wording::{Counted, count_path_pairs, json_line, name_of};

pub use distortion::Distortion;

/// The report of one repair; its fields are the JSON schema `untangled.fix/1`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name and version of this layout.
    pub schema: &'static str,
    /// The inputs as they were named; bytes that are not UTF-8 are replaced.
    pub files: Vec<String>,
    /// The outputs, named in the same way.
    pub outputs: Vec<String>,
    /// Whether an exact check of the outputs, read back, found no intersection.
    pub clean: bool,
    /// Whether the untangling was ended by the time limit.
    pub time_limit_reached: bool,
    /// Iterations of the relaxation; 0 if the input was clean.
    pub num_iterations: usize,
    /// Time from the start to the end of the last check, in seconds.
    pub seconds: f64,
    /// Intersections of the inputs.
    pub before: Counts,
    /// Intersections of the outputs, read back.
    pub after: Counts,
    /// How much the repair changed the shape.
    pub distortion: Distortion,
    /// Paths that could not be resolved.
    pub blocked: Vec<Blocked>,
    /// The state after each iteration.
    pub history: Vec<Iteration>,
}

/// Numbers of intersections of a state.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Edges that pierce faces.
    pub num_edge_face_intersections: usize,
    /// Intersecting pairs of triangles.
    pub num_face_pairs: usize,
    /// Number of path pairs by type.
    pub path_pairs: BTreeMap<PairType, usize>,
}

impl Counts {
    pub(super) fn new(analysis: &Analysis) -> Self {
        Self {
            num_edge_face_intersections: analysis.intersections.edge_face.len(),
            num_face_pairs: analysis.intersections.segments.len(),
            path_pairs: count_path_pairs(analysis),
        }
    }

    /// Whether there is no intersection.
    pub(super) fn is_clean(&self) -> bool {
        self.num_face_pairs == 0
    }
}

/// A path that could not be resolved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blocked {
    /// Its type.
    pub pair_type: PairType,
    /// A vertex next to it, counted over all files.
    pub vertex: u32,
    /// Its length in metres.
    pub length_m: f64,
    /// Why, in words.
    pub reason: String,
}

impl From<BlockedPath> for Blocked {
    fn from(path: BlockedPath) -> Self {
        let BlockedPath { pair_type, vertex, length_m, reason } = path;
        Self { pair_type, vertex, length_m, reason }
    }
}

impl Report {
    /// The document on one line.
    #[must_use]
    pub fn to_json(&self) -> String {
        json_line(self)
    }
}

impl Display for Report {
    /// The lines for people.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} -> {}", self.files.join(", "), self.outputs.join(", "))?;
        if self.before.is_clean() && self.clean {
            return writeln!(f, "  clean before: written unchanged");
        }
        writeln!(
            f,
            "  {}: {} became {}, {} became {}",
            if self.clean { "clean" } else { "not clean" },
            Counted(self.before.num_face_pairs, "intersecting face pair"),
            self.after.num_face_pairs,
            Counted(self.before.num_edge_face_intersections, "edge-face intersection"),
            self.after.num_edge_face_intersections,
        )?;
        write!(f, "  {} in {:.2} s", Counted(self.num_iterations, "iteration"), self.seconds)?;
        let mut methods: BTreeMap<String, usize> = BTreeMap::new();
        for iteration in &self.history {
            *methods.entry(name_of(iteration.method)).or_default() += 1;
        }
        let methods: Vec<String> = methods.iter().map(|(name, count)| format!("{name} {count}")).collect();
        writeln!(f, "{}{}", if methods.is_empty() { "" } else { ": " }, methods.join(", "))?;
        if self.time_limit_reached {
            writeln!(f, "  the time limit was reached: this is the best state until then")?;
        }
        let Distortion {
            max_displacement_m,
            mean_displacement_m,
            max_edge_stretch,
            mean_edge_stretch,
            num_overstretched_edges,
        } = self.distortion;
        writeln!(f, "  moved {max_displacement_m:.6} m at most, {mean_displacement_m:.6} m on average")?;
        writeln!(f, "  edges are {max_edge_stretch:.4} times as long at worst, {mean_edge_stretch:.4} on average")?;
        if num_overstretched_edges > 0 {
            writeln!(
                f,
                "  {} longer than {STRETCH_LIMIT} times the length before, or shorter than 1/{STRETCH_LIMIT} of it: \
                 the cloth is distorted there",
                Counted(num_overstretched_edges, "edge"),
            )?;
        }
        for Blocked { pair_type, vertex, length_m, reason } in &self.blocked {
            writeln!(f, "  left: {} of {length_m:.5} m at vertex {vertex}: {reason}", name_of(pair_type))?;
        }
        Ok(())
    }
}
