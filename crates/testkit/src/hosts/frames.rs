//! The same frames for the clients of all languages.
//!
//! They go through a file, all numbers in the machine's byte order: `num_vertices`, `num_triangles`, `num_frames`
//! (u32), triangles (u32 x 3), masses in kilograms (f64), then the positions of each frame (f32 x 3). Answers are bytes
//! as they came: for each frame the vertex corrections as forces, the records and the points of the paths.

use std::{path::Path, time::Instant};

use untangled_client::{Client, CorrectionKind, Registration};
use untangled_publisher::{
    mesh::{Cloth, to_f32},
    scenes::Scene,
};

use crate::process::{PATIENCE, STEP};

/// A cloth and its states.
#[derive(Debug)]
pub struct Frames {
    /// How it is registered.
    pub registration: Registration,
    /// Positions of each frame in metres.
    pub states: Vec<Vec<[f32; 3]>>,
}

impl Frames {
    /// A tangled scene that changes from frame to frame.
    pub fn tangled(scene: Scene, edge_m: f64, num_frames: u32) -> Self {
        let cloth = scene.build(1, edge_m);
        let state = |frame: u32| {
            let shift = |index: usize| 0.001 * f64::from(frame) * (0.7 * index as f64).sin();
            let moved = cloth.points().into_iter().enumerate().map(|(k, [x, y, z])| [x, y, z + shift(k)].map(to_f32));
            moved.collect()
        };
        Self { states: (0..num_frames).map(state).collect(), registration: registration(&cloth) }
    }

    /// Writes the scene file.
    pub fn write(&self, path: &Path) {
        let Registration { num_vertices, triangles, masses_kg, .. } = &self.registration;
        let counts = [*num_vertices, triangles.len(), self.states.len()].map(|count| u32::try_from(count).unwrap());
        let mut bytes: Vec<u8> = counts.iter().flat_map(|count| count.to_ne_bytes()).collect();
        bytes.extend(triangles.iter().flatten().flat_map(|index| index.to_ne_bytes()));
        bytes.extend(masses_kg.iter().flatten().flat_map(|mass| mass.to_ne_bytes()));
        bytes.extend(self.states.iter().flatten().flatten().flat_map(|value| value.to_ne_bytes()));
        std::fs::write(path, bytes).unwrap();
    }

    /// What the Rust client brings back.
    pub fn exchange(&self, client: &Client) -> Vec<u8> {
        let registration = Registration { paths: true, ..self.registration.clone() };
        let mut session = client.register(registration).unwrap();
        let mut bytes = Vec::new();
        for state in &self.states {
            let correction = session.exchange(STEP, PATIENCE, |slots| slots.copy_from_slice(state)).unwrap();
            for vertex in correction.vertices() {
                bytes.extend(vertex.value.iter().flat_map(|value| value.to_ne_bytes()));
                bytes.extend(vertex.flags.to_ne_bytes());
            }
            let paths = correction.paths().unwrap();
            paths.records.iter().for_each(|record| bytes.extend(record.to_bytes()));
            paths.points.iter().for_each(|point| bytes.extend(point.to_bytes()));
        }
        bytes
    }

    /// Median round trip of the Rust client in microseconds, each frame sent `repeats` times.
    pub fn round_trip_us(&self, client: &Client, repeats: usize) -> f64 {
        let mut session = client.register(self.registration.clone()).unwrap();
        let mut times = Vec::new();
        for state in std::iter::repeat_n(&self.states, repeats).flatten() {
            let begin = Instant::now();
            let correction = session.exchange(STEP, PATIENCE, |slots| slots.copy_from_slice(state)).unwrap();
            times.push(begin.elapsed().as_secs_f64() * 1e6);
            drop(correction);
        }
        times.sort_unstable_by(f64::total_cmp);
        times[times.len() / 2]
    }
}

fn registration(cloth: &Cloth) -> Registration {
    Registration {
        num_vertices: cloth.positions.len(),
        triangles: cloth.triangles.clone(),
        masses_kg: Some(cloth.masses_kg(0.2)),
        correction: CorrectionKind::Force,
        ..Registration::default()
    }
}
