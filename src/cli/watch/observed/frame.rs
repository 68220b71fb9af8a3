//! One frame as a message for the page: `report/src/watch/message.ts` says what is in it.

use std::{collections::BTreeMap, sync::Arc};

use serde::Serialize;
use untangled_client::{
    CorrectionKind, flags,
    observe::{Observation, ObservedMesh},
};

use super::{
    lines::{Lines, PathData},
    wrong::{SideFinder, Wrong, WrongSides},
};
use crate::cli::watch::message::Message;

/// Marks of a vertex on the page.
mod mark {
    pub(super) const MASKED: u8 = 1;
    pub(super) const CLAMPED: u8 = 2;
    pub(super) const PINNED: u8 = 4;
    pub(super) const BODY: u8 = 8;
    pub(super) const LAYER: u8 = 16;
}

#[derive(Debug, Serialize)]
struct Header {
    frame: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
    correction: &'static str,
    unit: &'static str,
    paths: Vec<PathData>,
    /// Where there is a body, or are several layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    wrong: Option<[WrongData; 2]>,
    counts: BTreeMap<&'static str, u64>,
    contour_length_m: f64,
    stage_us: BTreeMap<&'static str, f64>,
    /// How old the correction was when the page got it.
    latency_us: f64,
    simulated_s: f64,
    num_dropped: u64,
}

/// Vertices inside of a body, or behind an inner layer.
#[derive(Debug, Serialize)]
struct WrongData {
    kind: &'static str,
    num_vertices: usize,
    /// Of the deepest.
    depth_m: f64,
}

/// Makes messages of the frames of one session.
#[derive(Debug)]
pub(super) struct Framer {
    sides: Option<SideFinder>,
    is_pin: Vec<bool>,
    correction: CorrectionKind,
    /// Those of the last frame that had some.
    positions: Vec<[f32; 3]>,
}

impl Framer {
    pub(super) fn new(mesh: &ObservedMesh) -> Self {
        let mut is_pin = vec![false; mesh.num_vertices];
        mesh.pins.iter().for_each(|&vertex| is_pin[vertex as usize] = true);
        Self { sides: SideFinder::new(mesh), is_pin, correction: mesh.correction, positions: Vec::new() }
    }

    /// A frame; nothing where it has no positions and none before it had.
    pub(super) fn message(&mut self, seen: &Observation) -> Option<Arc<[u8]>> {
        if !seen.positions.is_empty() {
            self.positions.clone_from(&seen.positions);
        }
        if self.positions.is_empty() {
            return None;
        }
        let shown = Lines::new(seen);
        let mut inside = vec![0; seen.flags.len()];
        for entry in &seen.inside {
            inside[entry.vertex as usize] = shown.paths[entry.pair as usize].0.saturating_add(1);
        }
        let wrong = self.sides.as_mut().map(|sides| sides.find(&self.positions));
        let corrected: Vec<u32> =
            (0u32..).zip(&seen.corrections).filter(|(_, value)| is_nonzero(value)).map(|(vertex, _)| vertex).collect();
        let values: Vec<[f32; 3]> = seen.corrections.iter().filter(|value| is_nonzero(value)).copied().collect();
        let mut message = Message::default();
        message.singles("positions", self.positions.as_flattened());
        message.bytes("flags", &self.marks(&seen.flags, wrong.as_ref()));
        message.bytes("inside", &inside);
        message.whole("corrected", &corrected);
        message.singles("corrections", values.as_flattened());
        message.singles("points", shown.points.as_flattened());
        message.whole("lines", shown.lines.as_flattened());
        Some(message.finish(&self.header(seen, shown, wrong.as_ref())))
    }

    fn marks(&self, all: &[u32], wrong: Option<&WrongSides>) -> Vec<u8> {
        let mark = |(&own, &is_pin): (&u32, &bool)| {
            let masked = if own & flags::MASK != 0 { mark::MASKED } else { 0 };
            let clamped = if own & flags::CLAMPED != 0 { mark::CLAMPED } else { 0 };
            masked | clamped | if is_pin { mark::PINNED } else { 0 }
        };
        let mut marks: Vec<u8> = all.iter().zip(&self.is_pin).map(mark).collect();
        if let Some(WrongSides { body, layer }) = wrong {
            body.iter().for_each(|&(vertex, _)| marks[vertex as usize] |= mark::BODY);
            layer.iter().for_each(|&(vertex, _)| marks[vertex as usize] |= mark::LAYER);
        }
        marks
    }

    fn header(&self, seen: &Observation, shown: Lines, wrong: Option<&WrongSides>) -> Header {
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
            wrong: wrong.map(|wrong| [WrongData::new("body", &wrong.body), WrongData::new("layer", &wrong.layer)]),
            counts: counts.into_iter().collect(),
            contour_length_m: header.contour_length_m,
            stage_us: stages.into_iter().map(|(name, time)| (name, 1e6 * time.as_secs_f64())).collect(),
            latency_us: 1e6 * seen.age().as_secs_f64(),
            simulated_s: header.simulated_s,
            num_dropped: seen.num_dropped,
        }
    }
}

impl WrongData {
    fn new(kind: &'static str, wrong: &[Wrong]) -> Self {
        Self { kind, num_vertices: wrong.len(), depth_m: wrong.iter().map(|wrong| wrong.1).fold(0.0, f64::max) }
    }
}

fn is_nonzero(value: &[f32; 3]) -> bool {
    value.iter().any(|coordinate| coordinate.abs() > 0.0)
}
