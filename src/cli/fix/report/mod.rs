//! What `untangled fix` reports: one document, as JSON or as lines for people.

mod blocked;
mod counts;
mod distortion;
mod order;

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
};

use serde::Serialize;

use untangle::relax::{Iteration, STRETCH_LIMIT};

use crate::cli::{
    gap::GapReport,
    roles::{BodyReport, say_bodies, say_layers},
    wording::{Counted, json_line, name_of, welded, zeroed},
};

pub use blocked::Blocked;
pub use counts::{Counts, LayerChange};
pub use distortion::Distortion;
pub use order::ImpliedOrder;
use order::say_order;

/// The report of one repair; its fields are the JSON schema `untangled.fix/1`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name and version of this layout.
    pub schema: &'static str,
    /// The inputs as they were named; bytes that are not UTF-8 are replaced.
    pub files: Vec<String>,
    /// The outputs, named in the same way.
    pub outputs: Vec<String>,
    /// Whether exact checks of the outputs, read back, found no intersection, nor primitives nearer than the gap: by
    /// the library as they are, and by the judge for all readers.
    pub clean: bool,
    /// The bodies, if any were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Vec<BodyReport>>,
    /// The layers, if the files are layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<LayerChange>>,
    /// Pieces of cloth without a given order that ended in the one in which most of each was.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub implied_order: Vec<ImpliedOrder>,
    /// Vertices that are one with an earlier one in their place, and moved with it.
    pub num_welded_vertices: usize,
    /// Coordinates below 2^-250 m, which count as zero.
    pub num_zeroed_coordinates: usize,
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
    /// The distances of the outputs, read back, if a gap was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<GapReport>,
    /// How much the repair changed the shape.
    pub distortion: Distortion,
    /// Paths that could not be resolved.
    pub blocked: Vec<Blocked>,
    /// The state after each iteration.
    pub history: Vec<Iteration>,
}

/// Most paths that were left of which people are told; all are in the JSON document.
const MOST_LEFT: usize = 10;

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
        if self.num_zeroed_coordinates > 0 {
            writeln!(f, "  {}", zeroed(self.num_zeroed_coordinates))?;
        }
        if self.num_welded_vertices > 0 {
            writeln!(f, "  {}", welded(self.num_welded_vertices))?;
        }
        if self.before.is_certified() && self.clean && self.num_iterations == 0 {
            writeln!(f, "  clean before: written unchanged")?;
            return self.say_readers(f);
        }
        writeln!(
            f,
            "  {}: {} became {}, {} became {}",
            match (self.clean, self.after.is_certified()) {
                (true, _) => "clean",
                // What is left otherwise is said by its number.
                (false, true) => "nothing intersects, but the gap is not kept",
                (false, false) => "not clean",
            },
            Counted(self.before.num_face_pairs, "intersecting face pair"),
            self.after.num_face_pairs,
            Counted(self.before.num_edge_face_intersections, "edge-face intersection"),
            self.after.num_edge_face_intersections,
        )?;
        self.say_sides(f)?;
        self.say_readers(f)?;
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
        self.say_distortion(f)?;
        self.say_left(f)
    }
}

impl Report {
    /// What is left with bodies and layers, where there are any.
    fn say_sides(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if let (Some(before), Some(after)) = (self.before.bodies, self.after.bodies) {
            say_bodies(f, self.bodies.as_deref())?;
            writeln!(
                f,
                "  with bodies: {} became {}, {} inside became {}",
                Counted(before.num_body_face_pairs, "intersecting face pair"),
                after.num_body_face_pairs,
                Counted(before.num_vertices_inside_body, "vertex"),
                after.num_vertices_inside_body,
            )?;
        }
        say_layers(f, self.after.layers.as_deref())?;
        say_order(f, &self.implied_order)
    }

    /// How far the cloth moved, and how it was stretched.
    fn say_distortion(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Distortion {
            num_moved_vertices,
            max_displacement_m,
            mean_displacement_m,
            max_edge_stretch,
            mean_edge_stretch,
            num_overstretched_edges,
        } = self.distortion;
        let moved = Counted(num_moved_vertices, "vertex");
        writeln!(f, "  moved {moved}, {max_displacement_m:.6} m at most, {mean_displacement_m:.6} m on average")?;
        writeln!(f, "  edges are {max_edge_stretch:.4} times as long at worst, {mean_edge_stretch:.4} on average")?;
        if num_overstretched_edges > 0 {
            writeln!(
                f,
                "  {} longer than {STRETCH_LIMIT} times the length before, or shorter than 1/{STRETCH_LIMIT} of it: \
                 the cloth is distorted there",
                Counted(num_overstretched_edges, "edge"),
            )?;
        }
        Ok(())
    }

    /// What other readers find, where that differs, and the gap.
    fn say_readers(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.before.is_clean() && !self.before.certificate.is_clean() {
            writeln!(f, "  the input is clean in double precision as it is, but not for every reader:")?;
            write!(f, "{}", self.before.certificate)?;
        }
        let by_readers = self.after.certificate.to_string();
        if !by_readers.is_empty() {
            write!(f, "  what readers of the output find:\n{by_readers}")?;
        }
        self.gap.as_ref().map_or(Ok(()), |gap| write!(f, "{gap}"))
    }

    /// The paths that were left, the longest first.
    fn say_left(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut longest: Vec<&Blocked> = self.blocked.iter().collect();
        longest.sort_by(|a, b| b.length_m.total_cmp(&a.length_m));
        for blocked in longest.iter().take(MOST_LEFT) {
            let Blocked { pair_type, num_vertices_inside_body, file, vertex_in_file, part, length_m, reason, .. } =
                blocked;
            let part = part.as_ref().map_or_else(String::new, |part| format!(", {part}"));
            let what = match num_vertices_inside_body {
                Some(count) => format!("{} inside of a body, up to {length_m:.5} m deep,", Counted(*count, "vertex")),
                None => format!("{} of {length_m:.5} m", pair_type.map(name_of).unwrap_or_default()),
            };
            writeln!(f, "  left: {what} at vertex {vertex_in_file} of {file}{part}: {reason}")?;
        }
        if self.blocked.len() > MOST_LEFT {
            let more = Counted(self.blocked.len() - MOST_LEFT, "shorter path");
            writeln!(f, "  left: {more}; --json and --report list all")?;
        }
        if !self.blocked.is_empty() {
            writeln!(f, "  vertices are counted from 0 in each file")?;
        }
        Ok(())
    }
}
