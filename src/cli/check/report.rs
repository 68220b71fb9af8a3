//! What `untangled check` reports: one document, as JSON or as a table.

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
    path::PathBuf,
    time::Duration,
};

use serde::Serialize;

use untangle::{analysis::Analysis, paths::PairType, weld::Weld};

use super::{
    meetings::{Meeting, MeetingTable},
    pairs::PairReport,
};
use crate::cli::{
    certificate::Certificate,
    gap::GapReport,
    input::Input,
    roles::{BodyCounts, BodyReport, LayerReport, num_behind, say_bodies, say_layers},
    wording::{Counted, count_path_pairs, json_line, name_of, welded, zeroed},
};

/// The report of one check; its fields are the JSON schema `untangled.check/1`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name and version of this layout.
    pub schema: &'static str,
    /// The files as they were named; bytes that are not UTF-8 are replaced.
    pub files: Vec<String>,
    /// Vertices of all files, including unused ones.
    pub num_vertices: usize,
    /// Vertices that are one with an earlier one in their place.
    pub num_welded_vertices: usize,
    /// Coordinates below 2^-250 m, which count as zero.
    pub num_zeroed_coordinates: usize,
    /// Triangles.
    pub num_faces: usize,
    /// Triangles with a repeated vertex, which have no area to intersect.
    pub num_ignored_faces: usize,
    /// Sets of faces connected by edges.
    pub num_pieces: usize,
    /// Edges of one face.
    pub num_boundary_edges: usize,
    /// Whether there is no boundary edge.
    pub closed: bool,
    /// Whether the mesh is manifold at its edges and at its vertices.
    pub manifold: bool,
    /// Edges that pierce faces.
    pub num_edge_face_intersections: usize,
    /// Intersecting pairs of triangles.
    pub num_face_pairs: usize,
    /// Number of path pairs by type.
    pub path_pairs: BTreeMap<PairType, usize>,
    /// All path pairs.
    pub paths: Vec<PairReport>,
    /// Intersecting pairs of triangles `i < j`, sorted, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face_pairs: Option<Vec<[u32; 2]>>,
    /// What readers of the files find, by the judge.
    pub certificate: Certificate,
    /// Who intersects whom, where files, objects or groups have names; most pairs first.
    pub meetings: Vec<Meeting>,
    /// The distances of primitives, if a gap was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<GapReport>,
    /// The bodies, if any were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Vec<BodyReport>>,
    /// The layers, if the files are layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<LayerReport>>,
    /// What cloth and bodies have with each other; nothing without bodies.
    #[serde(flatten)]
    pub body_counts: Option<BodyCounts>,
    /// Time of each stage.
    pub time_us: StageTimes,
    /// Whether people are told the times.
    #[serde(skip)]
    pub verbose: bool,
}

/// Time of each stage in microseconds, in the order of the stages.
#[derive(Clone, Debug, Default)]
pub struct StageTimes(Vec<(&'static str, u64)>);

impl StageTimes {
    pub(super) const READ: &'static str = "read";
    pub(super) const MESH: &'static str = "mesh";
    pub(super) const CERTIFY: &'static str = "certify";
    pub(super) const GAP: &'static str = "gap";

    pub(super) fn add(&mut self, stage: &'static str, time: Duration) {
        self.0.push((stage, u64::try_from(time.as_micros()).unwrap_or(u64::MAX)));
    }
}

impl Serialize for StageTimes {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

impl Report {
    pub(super) fn new(
        files: &[PathBuf],
        shape @ Input { mesh, .. }: &Input,
        weld: &Weld,
        analysis: &Analysis,
        certificate: Certificate,
        time_us: StageTimes,
        list_face_pairs: bool,
    ) -> Self {
        let Analysis { intersections, .. } = analysis;
        let face_pairs = || intersections.segments.iter().map(|segment| segment.faces.map(|face| face.0)).collect();
        Self {
            schema: "untangled.check/1",
            files: files.iter().map(|path| path.display().to_string()).collect(),
            num_vertices: shape.weld.num_vertices(),
            num_welded_vertices: shape.weld.num_merged(),
            num_zeroed_coordinates: shape.num_zeroed_coordinates(),
            num_faces: mesh.num_faces(),
            num_ignored_faces: mesh.num_ignored_faces(),
            num_pieces: mesh.num_pieces(),
            num_boundary_edges: mesh.num_boundary_edges(),
            closed: mesh.is_closed(),
            manifold: mesh.is_manifold(),
            num_edge_face_intersections: intersections.edge_face.len(),
            num_face_pairs: intersections.segments.len(),
            path_pairs: count_path_pairs(analysis),
            paths: PairReport::of_all(weld, analysis),
            face_pairs: list_face_pairs.then(face_pairs),
            certificate,
            meetings: Vec::new(),
            gap: None,
            bodies: None,
            layers: None,
            body_counts: None,
            verbose: false,
            time_us,
        }
    }

    /// Whether nothing intersects, and no vertex of the cloth is inside of a body or behind an inner layer.
    pub(super) fn is_clean(&self) -> bool {
        self.num_face_pairs == 0
            && self.body_counts.is_none_or(|counts| counts.num_vertices_inside_body == 0)
            && num_behind(self.layers.as_deref()) == 0
    }

    /// The document on one line.
    #[must_use]
    pub fn to_json(&self) -> String {
        json_line(self)
    }
}

impl Display for Report {
    /// The table for people.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.files.join(", "))?;
        write!(f, "  {} vertices, ", self.num_vertices)?;
        for (count, noun) in [(self.num_faces, "face"), (self.num_pieces, "piece")] {
            write!(f, "{}, ", Counted(count, noun))?;
        }
        write!(f, "{}", Counted(self.num_boundary_edges, "boundary edge"))?;
        writeln!(f, "{}", if self.manifold { "" } else { ", not manifold" })?;
        if self.num_zeroed_coordinates > 0 {
            writeln!(f, "  {}", zeroed(self.num_zeroed_coordinates))?;
        }
        if self.num_welded_vertices > 0 {
            writeln!(f, "  {}", welded(self.num_welded_vertices))?;
        }
        if self.num_ignored_faces > 0 {
            writeln!(f, "  {} with a repeated vertex ignored", Counted(self.num_ignored_faces, "face"))?;
        }
        if self.num_face_pairs == 0 {
            writeln!(f, "  no intersections")?;
        } else {
            let pairs = Counted(self.num_face_pairs, "intersecting face pair");
            let hits = Counted(self.num_edge_face_intersections, "edge-face intersection");
            writeln!(f, "  {pairs}, {hits}\n")?;
            self.path_table(f)?;
            write!(f, "{}", MeetingTable(&self.meetings))?;
        }
        if let Some(BodyCounts { num_body_face_pairs, num_vertices_inside_body }) = self.body_counts {
            say_bodies(f, self.bodies.as_deref())?;
            let pairs = Counted(num_body_face_pairs, "intersecting face pair");
            writeln!(f, "  {pairs} with bodies, {} inside of a body", Counted(num_vertices_inside_body, "vertex"))?;
        }
        say_layers(f, self.layers.as_deref())?;
        if self.is_clean() && !self.certificate.is_clean() {
            write!(f, "  but not for every reader:\n{}", self.certificate)?;
        }
        if let Some(gap) = &self.gap {
            write!(f, "{gap}")?;
        }
        if let Some(face_pairs) = &self.face_pairs {
            writeln!(f, "\n  face pairs")?;
            for [first, second] in face_pairs {
                writeln!(f, "  {first} {second}")?;
            }
        }
        if !self.verbose {
            return Ok(());
        }
        let times: Vec<String> =
            self.time_us.0.iter().map(|(stage, us)| format!("{stage} {}.{:03} ms", us / 1000, us % 1000)).collect();
        writeln!(f, "\n  {}", times.join(", "))
    }
}

impl Report {
    fn path_table(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "  {:<14} {:>6} {:>11} {:>12} {:>16}",
            "path type", "pairs", "face pairs", "length (m)", "inside vertices"
        )?;
        for (&pair_type, &count) in &self.path_pairs {
            let (mut segments, mut length, mut inside) = (0, 0.0, 0);
            for pair in self.paths.iter().filter(|pair| pair.pair_type == pair_type) {
                segments += pair.num_segments;
                length += pair.length_m;
                inside +=
                    pair.copies.iter().filter_map(|copy| copy.inside_vertices.as_ref()).map(Vec::len).sum::<usize>();
            }
            let name = name_of(pair_type);
            writeln!(f, "  {name:<14} {count:>6} {segments:>11} {length:>12.5} {inside:>16}")?;
        }
        Ok(())
    }
}
