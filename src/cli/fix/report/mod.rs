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
    sides::{Sides, clusters},
};

use crate::cli::{
    certificate::Certificate,
    gap::GapReport,
    input::Input,
    owners::{OwnedVertex, Owners},
    roles::{BodyCounts, BodyReport, LayerReport, Roles, num_behind, say_bodies, say_layers},
    wording::{Counted, count_path_pairs, json_line, name_of, welded, zeroed},
};

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
    /// Whether exact checks of the outputs, read back, found no intersection, nor primitives nearer than the gap: by
    /// the library as they are, and by the judge for all readers.
    pub clean: bool,
    /// The bodies, if any were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Vec<BodyReport>>,
    /// The layers, if the files are layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<LayerChange>>,
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

/// What of a layer is behind the layers before it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LayerChange {
    /// The file as it was named.
    pub file: String,
    /// Vertices behind, before and after.
    pub num_vertices_behind: Change,
}

/// A count before and after.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// In the inputs.
    pub before: usize,
    /// In the outputs, read back.
    pub after: usize,
}

impl LayerChange {
    /// The layers of two states; nothing without any.
    pub(super) fn of(before: &Counts, after: &Counts) -> Option<Vec<Self>> {
        let pairs = before.layers.as_ref()?.iter().zip(after.layers.as_ref()?);
        let change = |(before, after): (&LayerReport, &LayerReport)| Self {
            file: before.file.clone(),
            num_vertices_behind: Change { before: before.num_vertices_behind, after: after.num_vertices_behind },
        };
        Some(pairs.map(change).collect())
    }
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
    /// What cloth and bodies have with each other; nothing without bodies.
    #[serde(flatten)]
    pub bodies: Option<BodyCounts>,
    /// The layers, if the files are layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<LayerReport>>,
    /// What readers of the files find, by the judge.
    pub certificate: Certificate,
}

impl Counts {
    pub(in crate::cli) fn new(analysis: &Analysis, roles: &Roles, input: &Input, certificate: Certificate) -> Self {
        Self {
            num_edge_face_intersections: analysis.intersections.edge_face.len(),
            num_face_pairs: analysis.intersections.segments.len(),
            path_pairs: count_path_pairs(analysis),
            bodies: BodyCounts::of(input, &analysis.intersections),
            layers: LayerReport::of(roles, input),
            certificate,
        }
    }

    /// Whether there is no intersection in the files as they are, and no vertex on the wrong side.
    pub(in crate::cli) fn is_clean(&self) -> bool {
        self.num_face_pairs == 0 && self.num_wrong() == 0
    }

    /// Vertices of the cloth inside of a body, or behind an inner layer.
    pub(super) fn num_wrong(&self) -> usize {
        let num_inside = self.bodies.map_or(0, |bodies| bodies.num_vertices_inside_body);
        num_inside + num_behind(self.layers.as_deref())
    }

    /// Whether no reader of the files finds an intersection.
    pub(in crate::cli) fn is_certified(&self) -> bool {
        self.is_clean() && self.certificate.is_clean()
    }
}

/// A path that could not be resolved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blocked {
    /// Its type; nothing for vertices inside of a body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pair_type: Option<PairType>,
    /// For vertices inside of a body, joined by edges, how many they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_inside_body: Option<usize>,
    /// A vertex next to it, counted from 0 over all files.
    pub vertex: u32,
    /// The file of that vertex.
    pub file: String,
    /// The vertex counted from 0 in its file.
    pub vertex_in_file: usize,
    /// The object or group that it stands in, if that has a name.
    pub part: Option<String>,
    /// Its length in metres; of vertices inside of a body the largest depth.
    pub length_m: f64,
    /// Why, in words.
    pub reason: String,
}

impl From<BlockedPath> for Blocked {
    fn from(path: BlockedPath) -> Self {
        let BlockedPath { pair_type, vertex, length_m, reason } = path;
        Self {
            pair_type: Some(pair_type),
            num_vertices_inside_body: None,
            vertex,
            file: String::new(),
            vertex_in_file: vertex as usize,
            part: None,
            length_m,
            reason,
        }
    }
}

impl Blocked {
    /// What is inside of bodies in a state, cluster by cluster.
    pub(super) fn inside_bodies(Input { weld, mesh, frame, .. }: &Input) -> Vec<Self> {
        let Some(sides) = Sides::of(mesh, frame) else { return Vec::new() };
        let blocked = clusters(mesh, &sides.wrong_vertices(mesh, frame)).into_iter().map(|cluster| {
            let vertex = weld.first(cluster.vertex);
            let reason = match cluster.num_pinned {
                0 => "no motion brought it out of the body without crushing or overstretching the cloth",
                count if count == cluster.num_vertices => "all its vertices are pinned, inside of a body",
                _ => "a part of it is pinned inside of a body",
            };
            Self {
                pair_type: None,
                num_vertices_inside_body: Some(cluster.num_vertices),
                vertex,
                file: String::new(),
                vertex_in_file: vertex as usize,
                part: None,
                length_m: cluster.depth_m,
                reason: reason.to_owned(),
            }
        });
        blocked.collect()
    }

    /// Says to whom the vertices of paths belong.
    pub(in crate::cli) fn name_owners(blocked: &mut [Self], owners: &Owners<'_>) {
        let of = owners.of_vertices(blocked.iter().map(|path| path.vertex));
        for (path, owner) in blocked.iter_mut().zip(of) {
            if let Some(OwnedVertex { file, vertex_in_file, part }) = owner {
                (path.file, path.vertex_in_file, path.part) = (file, vertex_in_file, part);
            }
        }
    }
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
        say_layers(f, self.after.layers.as_deref())
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
