//! One frame as a message for the page: `report/src/watch/message.ts` says what is in it.

use std::{collections::BTreeMap, sync::Arc};

use serde::Serialize;
use untangled_client::{
    CorrectionKind, PathPoint, PathRecord, flags,
    observe::{Observation, ObservedMesh, path_state},
    path_type,
};
use untangled_proto::pair_type;

use super::regions::{NONE, Neighbours, Region, distance, single};
use crate::cli::watch::message::Message;

/// Marks of a vertex on the page.
mod mark {
    pub(super) const MASKED: u8 = 1;
    pub(super) const CLAMPED: u8 = 2;
    pub(super) const PINNED: u8 = 4;
}

#[derive(Debug, Serialize)]
struct Header {
    frame: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
    correction: &'static str,
    unit: &'static str,
    paths: Vec<PathData>,
    counts: BTreeMap<&'static str, u64>,
    contour_length_m: f64,
    stage_us: BTreeMap<&'static str, f64>,
    /// How old the correction was when the page got it.
    latency_us: f64,
    simulated_s: f64,
    num_dropped: u64,
}

/// One pair of paths.
#[derive(Debug, Default, Serialize)]
struct PathData {
    pair_type: &'static str,
    length_m: f64,
    facts: Vec<(String, String)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'static str>,
}

/// Makes messages of the frames of one session.
#[derive(Debug)]
pub(super) struct Framer {
    triangles: Vec<[u32; 3]>,
    neighbours: Neighbours,
    is_pin: Vec<bool>,
    correction: CorrectionKind,
    /// Those of the last frame that had some.
    positions: Vec<[f32; 3]>,
}

impl Framer {
    pub(super) fn new(mesh: &ObservedMesh) -> Self {
        let mut is_pin = vec![false; mesh.num_vertices];
        mesh.pins.iter().for_each(|&vertex| is_pin[vertex as usize] = true);
        Self {
            triangles: mesh.triangles.clone(),
            neighbours: Neighbours::new(mesh.num_vertices, &mesh.triangles),
            is_pin,
            correction: mesh.correction,
            positions: Vec::new(),
        }
    }

    /// A frame; nothing where it has no positions and none before it had.
    pub(super) fn message(&mut self, seen: &Observation) -> Option<Arc<[u8]>> {
        if !seen.positions.is_empty() {
            self.positions.clone_from(&seen.positions);
        }
        if self.positions.is_empty() {
            return None;
        }
        let paths = seen.paths();
        let is_inside = |vertex: u32| seen.flags[vertex as usize] & flags::INSIDE != 0;
        let of_paths = (paths.records, paths.points);
        let (pairs, regions) = self.neighbours.regions(&self.triangles, &self.positions, is_inside, of_paths);
        let shown = Lines::new(paths.records, paths.points, &regions);
        let types: Vec<u8> = shown.paths.iter().map(|(number, _)| *number).collect();
        let inside: Vec<u8> =
            pairs.iter().map(|&pair| if pair == NONE { 0 } else { types[pair as usize] + 1 }).collect();
        let corrected: Vec<u32> =
            (0u32..).zip(&seen.corrections).filter(|(_, value)| is_nonzero(value)).map(|(vertex, _)| vertex).collect();
        let values: Vec<[f32; 3]> = seen.corrections.iter().filter(|value| is_nonzero(value)).copied().collect();
        let mut message = Message::default();
        message.singles("positions", self.positions.as_flattened());
        message.bytes("flags", &self.marks(&seen.flags));
        message.bytes("inside", &inside);
        message.whole("corrected", &corrected);
        message.singles("corrections", values.as_flattened());
        message.singles("points", shown.points.as_flattened());
        message.whole("lines", shown.lines.as_flattened());
        Some(message.finish(&self.header(seen, shown)))
    }

    fn marks(&self, all: &[u32]) -> Vec<u8> {
        let mark = |(&own, &is_pin): (&u32, &bool)| {
            let masked = if own & flags::MASK != 0 { mark::MASKED } else { 0 };
            let clamped = if own & flags::CLAMPED != 0 { mark::CLAMPED } else { 0 };
            masked | clamped | if is_pin { mark::PINNED } else { 0 }
        };
        all.iter().zip(&self.is_pin).map(mark).collect()
    }

    fn header(&self, seen: &Observation, shown: Lines) -> Header {
        let header = seen.header();
        let (correction, unit) = match self.correction {
            CorrectionKind::Displacement => ("displacement", "m"),
            CorrectionKind::Force => ("force", "N"),
            CorrectionKind::Acceleration => ("acceleration", "m/s²"),
            CorrectionKind::VelocityChange => ("velocity", "m/s"),
        };
        let counts = [
            ("num_edge_face_intersections", header.num_edge_face_intersections),
            ("num_face_pairs", header.num_face_pairs),
            ("num_inside", header.num_inside),
            ("num_paths", shown.paths.len() as u64),
            ("num_skipped_frames", header.num_skipped_frames),
        ];
        let stages = seen.stage_times();
        Header {
            frame: seen.frame(),
            refused: seen.refusal().map(|refusal| refusal.to_string()),
            correction,
            unit,
            paths: shown.paths.into_iter().map(|(_, path)| path).collect(),
            counts: counts.into_iter().collect(),
            contour_length_m: header.contour_length_m,
            stage_us: stages.into_iter().map(|(name, time)| (name, 1e6 * time.as_secs_f64())).collect(),
            latency_us: 1e6 * seen.age().as_secs_f64(),
            simulated_s: header.simulated_s,
            num_dropped: seen.num_dropped,
        }
    }
}

fn is_nonzero(value: &[f32; 3]) -> bool {
    value.iter().any(|coordinate| coordinate.abs() > 0.0)
}

/// All pairs as lines, and what is known of them.
#[derive(Debug, Default)]
struct Lines {
    /// With the number of the type.
    paths: Vec<(u8, PathData)>,
    points: Vec<[f32; 3]>,
    /// Pair, first point, number of points.
    lines: Vec<[u32; 3]>,
}

impl Lines {
    fn new(records: &[PathRecord], points: &[PathPoint], regions: &[Region]) -> Self {
        let mut all = Self::default();
        all.paths.resize_with(regions.len(), Default::default);
        for (number, record) in records.iter().enumerate() {
            let own = record.points(points);
            let (kind, path) = &mut all.paths[record.pair as usize];
            if path.pair_type.is_empty() {
                *kind = u8::try_from(record.pair_type).unwrap_or_default();
                path.pair_type = pair_type::NAMES.get(record.pair_type as usize).copied().unwrap_or("?");
                path.facts.push(("State".to_owned(), state_words(record.state).to_owned()));
            }
            path.facts.push(copy_fact(record, own));
            if record.state == path_state::LEFT_OUT {
                path.reason = Some("the time of the frame was up before these paths were worked on");
            }
            // Corresponding paths are one curve in the world: it is drawn once.
            if (record.partner as usize) < number {
                continue;
            }
            let places = own.iter().map(|point| point.position_m.map(single));
            let first = all.points.len();
            all.points.extend(places);
            let length = |ends: &[[f32; 3]]| f64::from(distance(ends[0], ends[1]));
            path.length_m += all.points[first..].windows(2).map(length).sum::<f64>();
            let [first, count] = [first, own.len()].map(|value| u32::try_from(value).unwrap_or(u32::MAX));
            all.lines.push([record.pair, first, count]);
        }
        for ((_, path), region) in all.paths.iter_mut().zip(regions) {
            path.facts.push(("Vertices inside".to_owned(), region.num_vertices.to_string()));
            if region.num_vertices > 0 {
                let words = format!("up to {:.1} mm from the path, along edges", 1e3 * region.depth_m);
                path.facts.push(("Depth".to_owned(), words));
            }
        }
        all
    }
}

fn state_words(state: u32) -> &'static str {
    match state {
        path_state::REGION => "worked on: there are vertices inside",
        path_state::NO_REGION => "no vertex is inside",
        path_state::LEFT_OUT => "left out",
        _ => "not known",
    }
}

/// What kind of path a copy is, and where its ends are.
fn copy_fact(record: &PathRecord, points: &[PathPoint]) -> (String, String) {
    let (name, ends) = match record.path_type {
        path_type::CLOSED => ("CLOSED", "no ends"),
        path_type::LOOP_LOOP => ("LL", "two loop vertices"),
        path_type::BOUNDARY_LOOP_INSIDE => ("BLI", "one end on the boundary, one inside, round a loop vertex"),
        path_type::BOUNDARY_LOOP_BOUNDARY => ("BLB", "both ends on the boundary, round a loop vertex"),
        path_type::BOUNDARY_BOUNDARY => ("BB", "both ends on the boundary"),
        path_type::BOUNDARY_INSIDE => ("BI", "one end on the boundary, one inside"),
        path_type::INSIDE_INSIDE => ("II", "both ends inside of the cloth"),
        _ => ("?", "of a type that is not known here"),
    };
    let faces = match (points.first(), points.last()) {
        (Some(first), Some(last)) if record.closed == 0 => {
            format!(", from face {} to face {}", first.faces[0], last.faces[0])
        }
        _ => String::new(),
    };
    (format!("Path {name}"), format!("{ends}{faces}; {} face pairs", points.len().saturating_sub(1)))
}
