//! One fuzzer for all targets.

use std::sync::Arc;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    settings::Settings,
    untangler::Untangler,
};
use untangled::service::ServeOptions;
use untangled_proto::{
    PositionF32, PositionF64, StateHeader,
    sections::{SectionWriter, id},
};
use untangled_transport::Domain;

use crate::intake::{Positions, accept_state, read_registration, read_settings};

use super::{
    bytes,
    checks::{check_frame, check_mesh},
    inputs::{
        damage::damage,
        grid::grid,
        mesh_files::{gltf, obj, ply, stl},
        requests::{document, registration},
        stages,
    },
};

/// What the targets need, made once.
pub(super) struct Fuzzer {
    options: ServeOptions,
    frame: Frame,
    meshes: Vec<Untangler>,
}

const EXTENSIONS: [&str; 5] = ["obj", "ply", "gltf", "glb", "stl"];

impl Fuzzer {
    pub(super) fn new() -> Self {
        let domain = Domain::new("fuzz", None, 0).expect("the name is short");
        let options = ServeOptions { max_vertices: 10_000, max_faces: 10_000, ..ServeOptions::new(domain) };
        let untangler = |faces: Vec<[u32; 3]>, num_vertices| {
            let description = MeshDescription { num_vertices, faces, ..MeshDescription::default() };
            let mesh = Mesh::new(description).expect("it is a mesh");
            Untangler::new(Arc::new(mesh), Settings::default()).expect("defaults are valid")
        };
        let meshes = vec![
            untangler(vec![[0, 1, 2], [3, 4, 5]], 6),
            untangler(vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [6, 7, 8]], 9),
            untangler(grid(2), 9),
            untangler(grid(4), 25),
        ];
        Self { options, frame: Frame::default(), meshes }
    }

    /// A frame; returns whether it was accepted.
    pub(super) fn ingest(&mut self, rng: &mut ChaCha8Rng) -> bool {
        // The largest takes most time, and is worth it now and then.
        let which = if rng.random_bool(0.03) { 3 } else { rng.random_range(0..3) };
        let untangler = &mut self.meshes[which];
        let mesh = Arc::clone(untangler.mesh());
        let n = mesh.num_vertices();
        let length = if rng.random_bool(0.9) { n } else { rng.random_range(0..2 * n) };
        let wildness = [0.0, 0.02, 0.5][rng.random_range(0..3)];
        let scale = 10f64.powi(if rng.random_bool(0.8) { 0 } else { rng.random_range(-80..80) });
        let lattice = rng.random_bool(0.4);
        let coordinate = |rng: &mut ChaCha8Rng| {
            if rng.random_bool(wildness) {
                f64::from_bits(rng.random())
            } else if lattice {
                // Many coincidences.
                f64::from(rng.random_range(-2..3)) * scale
            } else {
                rng.random_range(-1.0..1.0) * scale
            }
        };
        let positions: Vec<[f64; 3]> = (0..length).map(|_| std::array::from_fn(|_| coordinate(rng))).collect();
        let header = StateHeader {
            frame: rng.random(),
            simulated_s: coordinate(rng),
            dt_s: if rng.random_bool(0.8) { 0.01 } else { f64::from_bits(rng.random()) },
            num_vertices: if rng.random_bool(0.9) { n as u32 } else { rng.random() },
            flags: rng.random(),
            progress: rng.random(),
            repair_deadline_us: rng.random(),
            reserved: rng.random(),
        };
        let accepted = if rng.random() {
            let positions: Vec<_> = positions.iter().map(|p| PositionF32(p.map(|x| x as f32))).collect();
            accept_state(&header, Positions::F32(&positions), &mesh, &mut self.frame)
        } else {
            let positions: Vec<_> = positions.iter().map(|&p| PositionF64(p)).collect();
            accept_state(&header, Positions::F64(&positions), &mesh, &mut self.frame)
        };
        if accepted {
            check_frame(untangler, &self.frame);
        }
        accepted
    }

    /// A registration; returns whether it was accepted.
    pub(super) fn register(&mut self, rng: &mut ChaCha8Rng) -> bool {
        let (mut payload, mut num_sections) = registration(rng);
        if rng.random_bool(0.6) {
            damage(rng, &mut payload);
        }
        if rng.random_bool(0.05) {
            num_sections = rng.random();
        }
        let Ok((mesh, settings)) = read_registration(&payload, num_sections, &self.options) else { return false };
        assert_eq!(settings.validate(), Ok(()));
        check_mesh(&mesh);
        let positions: Vec<[f64; 3]> =
            (0..mesh.num_vertices()).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
        self.frame.set(&mesh, positions.into_iter()).expect("positions are finite");
        let mut untangler = Untangler::new(mesh, settings).expect("settings were checked");
        check_frame(&mut untangler, &self.frame);
        true
    }

    /// A settings document; returns whether it was accepted.
    pub(super) fn settings(&mut self, rng: &mut ChaCha8Rng) -> bool {
        let mut document = document(rng);
        if rng.random_bool(0.4) {
            damage(rng, &mut document);
        }
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        let Ok(settings) = read_settings(&payload, num_sections, &self.options) else { return false };
        assert_eq!(settings.validate(), Ok(()));
        // What is valid can be used.
        let untangler = &mut self.meshes[1];
        untangler.set_settings(settings).expect("settings were checked");
        let positions: Vec<[f64; 3]> = (0..9).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
        self.frame.set(&Arc::clone(untangler.mesh()), positions.into_iter()).expect("positions are finite");
        check_frame(untangler, &self.frame);
        untangler.set_settings(Settings::default()).expect("defaults are valid");
        true
    }

    /// A mesh file; returns whether it was accepted.
    pub(super) fn mesh_file(rng: &mut ChaCha8Rng) -> bool {
        let extension = EXTENSIONS[rng.random_range(0..EXTENSIONS.len())];
        let mut bytes = match extension {
            "obj" => obj(rng),
            "ply" => ply(rng),
            "gltf" => gltf(rng, false),
            "stl" => stl(rng),
            _ => gltf(rng, true),
        };
        if rng.random_bool(0.7) {
            damage(rng, &mut bytes);
        }
        bytes::mesh_file(extension, &bytes)
    }

    /// A stage of USD; returns whether it was accepted.
    pub(super) fn stage(rng: &mut ChaCha8Rng) -> bool {
        let mut bytes = match rng.random_range(0..4) {
            0 => stages::QUADS_BINARY.to_vec(),
            1 => stages::QUADS_ARCHIVE.to_vec(),
            _ => stages::text(rng),
        };
        if rng.random_bool(0.7) {
            damage(rng, &mut bytes);
        }
        bytes::usd(&bytes)
    }
}
