//! The paths of a frame as lines, and what is known of each pair.

use serde::Serialize;
use untangled_client::{
    PathPoint, PathRecord,
    observe::{Observation, path_state},
    path_type,
};
use untangled_proto::pair_type;

/// One pair of paths.
#[derive(Debug, Default, Serialize)]
pub(super) struct PathData {
    pub(super) pair_type: &'static str,
    length_m: f64,
    facts: Vec<(String, String)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'static str>,
}

/// All pairs as lines, and what is known of them.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// With the number of the type.
    pub(super) paths: Vec<(u8, PathData)>,
    pub(super) points: Vec<[f32; 3]>,
    /// Pair, first point, number of points.
    pub(super) lines: Vec<[u32; 3]>,
}

impl Lines {
    pub(super) fn new(seen: &Observation) -> Self {
        let (records, points) = (seen.paths().records, seen.paths().points);
        let mut all = Self::default();
        let num_pairs = records.iter().map(|record| record.pair as usize + 1).max().unwrap_or(0);
        all.paths.resize_with(num_pairs, Default::default);
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
        let mut num_inside = vec![0; num_pairs];
        seen.inside.iter().for_each(|entry| num_inside[entry.pair as usize] += 1);
        for (pair, ((_, path), num_inside)) in all.paths.iter_mut().zip(num_inside).enumerate() {
            path.facts.push(("Vertices inside".to_owned(), num_inside.to_string()));
            if let Some(depth_m) = seen.depths_m.get(pair).filter(|depth_m| **depth_m > 0.0) {
                let words = format!("up to {:.1} mm from where it should be", 1e3 * depth_m);
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

#[expect(clippy::cast_possible_truncation, reason = "to look at")]
fn single(value: f64) -> f32 {
    value as f32
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f32>().sqrt()
}
