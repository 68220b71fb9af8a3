//! A seeded random fuzzer for whatever bytes come from outside. Each input ends in an error in words or in the invariants; a panic is a find.
//!
//! An input is a valid one with some damage, or noise; the same seed and number give the same input. A find names both.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::Arc,
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{frame::Frame, mesh::{Mesh, MeshDescription}, respond::VertexFlags, settings::Settings, untangler::Untangler};
use untangled_mesh_io::{MeshFile, concatenate, read_mesh};
use untangled::service::{
        ServeOptions,
        fuzz::{self, Positions},
    };
use untangled_transport::Domain;
use untangled_proto::{PositionF32, PositionF64, RegisterParams, StateHeader, sections::{SectionWriter, id}};

/// What bytes go into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Headers and positions of frames.
    Ingest,
    /// Registrations.
    Register,
    /// Settings documents.
    Settings,
    /// Mesh files.
    MeshFile,
}

/// Tries inputs `first..first + count` of a seed; returns how many were accepted, or the first find.
pub fn run(target: Target, seed: u64, first: u64, count: u64) -> Result<u64, String> {
    let mut fuzzer = Fuzzer::new();
    let mut num_accepted = 0;
    for input in first..first + count {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ input.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let tried = catch_unwind(AssertUnwindSafe(|| match target {
            Target::Ingest => fuzzer.ingest(&mut rng),
            Target::Register => fuzzer.register(&mut rng),
            Target::Settings => fuzzer.settings(&mut rng),
            Target::MeshFile => fuzzer.mesh_file(&mut rng),
        }));
        match tried {
            Ok(accepted) => num_accepted += u64::from(accepted),
            Err(_) => return Err(format!("{target:?}: input {input} of seed {seed} panicked (see above)")),
        }
    }
    Ok(num_accepted)
}

struct Fuzzer {
    options: ServeOptions,
    frame: Frame,
    meshes: Vec<Untangler>,
    file: PathBuf,
}

impl Drop for Fuzzer {
    fn drop(&mut self) {
        for extension in EXTENSIONS {
            let _ = std::fs::remove_file(self.file.with_extension(extension));
        }
    }
}

const EXTENSIONS: [&str; 4] = ["obj", "ply", "gltf", "glb"];

impl Fuzzer {
    fn new() -> Self {
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
        let name = format!("untangled-fuzz-{}-{:?}", std::process::id(), std::thread::current().id());
        Self { options, frame: Frame::default(), meshes, file: PathBuf::from("/dev/shm").join(name) }
    }

    fn ingest(&mut self, rng: &mut ChaCha8Rng) -> bool {
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
            reserved: rng.random(),
        };
        let accepted = if rng.random() {
            let positions: Vec<_> = positions.iter().map(|p| PositionF32(p.map(|x| x as f32))).collect();
            fuzz::state(&header, Positions::F32(&positions), &mesh, &mut self.frame)
        } else {
            let positions: Vec<_> = positions.iter().map(|&p| PositionF64(p)).collect();
            fuzz::state(&header, Positions::F64(&positions), &mesh, &mut self.frame)
        };
        if accepted {
            check_frame(untangler, &self.frame);
        }
        accepted
    }

    fn register(&mut self, rng: &mut ChaCha8Rng) -> bool {
        let (mut payload, mut num_sections) = registration(rng);
        if rng.random_bool(0.6) {
            damage(rng, &mut payload);
        }
        if rng.random_bool(0.05) {
            num_sections = rng.random();
        }
        let Ok((mesh, settings)) = fuzz::registration(&payload, num_sections, &self.options) else { return false };
        assert_eq!(settings.validate(), Ok(()));
        check_mesh(&mesh);
        let positions: Vec<[f64; 3]> =
            (0..mesh.num_vertices()).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
        self.frame.set(&mesh, positions.into_iter()).expect("positions are finite");
        let mut untangler = Untangler::new(mesh, settings).expect("settings were checked");
        check_frame(&mut untangler, &self.frame);
        true
    }

    fn settings(&mut self, rng: &mut ChaCha8Rng) -> bool {
        let mut document = document(rng);
        if rng.random_bool(0.4) {
            damage(rng, &mut document);
        }
        let (payload, num_sections) = SectionWriter::default().bytes(id::SETTINGS, document).finish();
        let Ok(settings) = fuzz::settings(&payload, num_sections, &self.options) else { return false };
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

    fn mesh_file(&mut self, rng: &mut ChaCha8Rng) -> bool {
        let extension = EXTENSIONS[rng.random_range(0..EXTENSIONS.len())];
        let mut bytes = match extension {
            "obj" => obj(rng),
            "ply" => ply(rng),
            "gltf" => gltf(rng, false),
            _ => gltf(rng, true),
        };
        if rng.random_bool(0.7) {
            damage(rng, &mut bytes);
        }
        let path = self.file.with_extension(extension);
        std::fs::write(&path, &bytes).expect("there is room for a small file");
        let Ok(file) = read_mesh(&path) else { return false };
        check_file(&file, &bytes);
        let Ok(world) = concatenate(std::slice::from_ref(&file)) else { return false };
        let positions = world.positions.clone();
        let Ok(mesh) = Mesh::new(world.description) else { return false };
        check_mesh(&mesh);
        if self.frame.set(&mesh, positions.into_iter()).is_ok() {
            check_frame(
                &mut Untangler::new(Arc::new(mesh), Settings::default()).expect("defaults are valid"),
                &self.frame,
            );
        }
        true
    }
}

/// What holds for every mesh: adjacency is consistent.
fn check_mesh(mesh: &Mesh) {
    for k in 0..mesh.num_faces() {
        let face = untangle::mesh::FaceId(k as u32);
        let corners = mesh.face(face);
        // A face with a repeated index is ignored.
        let ignored = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
        for vertex in corners {
            assert!(vertex.index() < mesh.num_vertices());
            assert_eq!(mesh.vertex_faces(vertex).contains(&face), !ignored, "a face is round its corners");
        }
    }
}

/// What holds for every frame: the answer is complete, finite, and the same each time.
fn check_frame(untangler: &mut Untangler, frame: &Frame) {
    let n = untangler.mesh().num_vertices();
    let outcome = untangler.process(frame, &mut ());
    let (paths, corrections) = (&outcome.analysis.paths, outcome.corrections);
    let num_segments = outcome.analysis.intersections.segments.len();
    assert_eq!(paths.pairs.iter().map(|pair| pair.num_segments).sum::<usize>(), num_segments, "segments on paths");
    for copy in &paths.copies {
        assert_eq!(paths.copies[copy.partner].pair, copy.pair);
    }
    assert_eq!(outcome.analysis.regions.by_copy.len(), paths.copies.len());
    assert_eq!((corrections.forces.len(), corrections.flags.len()), (n, n));
    assert!(corrections.forces.iter().flatten().all(|x| x.is_finite()), "forces are finite");
    let all = VertexFlags::INSIDE.0 | VertexFlags::NEAR_PATH.0 | VertexFlags::CLAMPED.0 | VertexFlags::PINNED.0;
    assert!(corrections.flags.iter().all(|flags| flags.0 & !all == 0));
    assert_eq!(corrections.left_out.num_pairs, 0, "nothing is left out without a limit");
    let first: Vec<_> = corrections.forces.clone();
    let again = untangler.process(frame, &mut ());
    assert!(first == again.corrections.forces, "the same frame, the same answer");
}

/// What holds for every file that was read: it is written back as it was.
fn check_file(file: &MeshFile, bytes: &[u8]) {
    assert!(file.faces().iter().flatten().all(|&corner| (corner as usize) < file.positions().len()));
    let mut written = Vec::new();
    if file.write_with_positions(file.positions(), &mut written).is_ok() {
        assert!(written == bytes, "a file is written back as it was");
    }
}

/// Changes some bytes, or cuts, repeats or moves some.
fn damage(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>) {
    for _ in 0..rng.random_range(1..5) {
        if bytes.is_empty() {
            return;
        }
        let at = rng.random_range(0..bytes.len());
        let end = (at + rng.random_range(1..32)).min(bytes.len());
        match rng.random_range(0..7) {
            0 => bytes[at] = rng.random(),
            1 => bytes[at] ^= 1 << rng.random_range(0..8),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                let to = rng.random_range(0..=bytes.len());
                bytes.splice(to..to, piece);
            }
            5 => bytes[at..end].fill([0, 255, b'9', b'-', b' ', b'\n'][rng.random_range(0..6)]),
            _ => {
                let value = [0u64, 1, u64::MAX, 1 << 31, 1 << 32, 1 << 63][rng.random_range(0..6)].to_le_bytes();
                for (byte, value) in bytes[at..].iter_mut().zip(value) {
                    *byte = value;
                }
            }
        }
    }
}

fn grid(n: u32) -> Vec<[u32; 3]> {
    let squares = (0..n * n).map(move |k| k / n * (n + 1) + k % n);
    squares.flat_map(|a| [[a, a + 1, a + n + 1], [a + n + 1, a + 1, a + n + 2]]).collect()
}

/// A registration that is valid more often than not.
fn registration(rng: &mut ChaCha8Rng) -> (Vec<u8>, u32) {
    let n = rng.random_range(1..4u32);
    let num_vertices = ((n + 1) * (n + 1)) as usize;
    let mut faces = grid(n);
    if rng.random_bool(0.2) {
        let face = rng.random_range(0..faces.len());
        faces[face][rng.random_range(0..3)] = rng.random_range(0..num_vertices as u32 + 1);
    }
    let params = RegisterParams {
        num_vertices: num_vertices as u64,
        precision: rng.random_range(0..2),
        correction: rng.random_range(0..4),
        reserved: rng.random(),
    };
    let mut writer = SectionWriter::default();
    writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &faces);
    let float = |rng: &mut ChaCha8Rng| {
        if rng.random_bool(0.01) { f64::from_bits(rng.random()) } else { rng.random_range(0.0..1.0) }
    };
    if rng.random() {
        let coordinates: Vec<[f64; 2]> = (0..num_vertices).map(|_| [float(rng), float(rng)]).collect();
        writer.f64s(id::UV_COORDINATES, &coordinates).u32s(id::UV_CORNERS, &faces);
    }
    if rng.random() {
        let rest: Vec<[f64; 3]> = (0..num_vertices).map(|_| [float(rng), float(rng), float(rng)]).collect();
        writer.f64s(id::REST_POSITIONS, &rest);
    }
    if rng.random_bool(0.8) {
        let masses: Vec<[f64; 1]> = (0..num_vertices).map(|_| [float(rng)]).collect();
        writer.f64s(id::MASSES, &masses);
    }
    if rng.random() {
        let pins: Vec<[u32; 1]> = (0..3).map(|_| [rng.random_range(0..num_vertices as u32)]).collect();
        let layers: Vec<[u32; 1]> = (0..num_vertices).map(|_| [rng.random_range(0..3)]).collect();
        writer.u32s(id::PINS, &pins).u32s(id::LAYERS, &layers);
    }
    if rng.random() {
        writer.bytes(id::SETTINGS, document(rng));
    }
    writer.finish()
}

/// A settings document that is valid more often than not.
fn document(rng: &mut ChaCha8Rng) -> Vec<u8> {
    const VALUES: [(&str, &[&str]); 14] = [
        ("quality", &["\"fast\"", "\"balanced\"", "\"accurate\"", "\"best\""]),
        ("response", &["\"rbf\"", "\"contour\"", "\"displacement\"", "\"mask\"", "1"]),
        ("inside", &["\"count\"", "\"area\"", "\"work\"", "null"]),
        ("layer_order", &["true", "false"]),
        ("winding", &["true", "false"]),
        ("pinned_outside", &["true", "false", "0"]),
        ("stiffness_per_step2", &["0", "0.5", "1e300", "5e-324", "-1"]),
        ("max_step_edge_lengths", &["0", "0.2", "1e308", "1e400"]),
        ("thickness_m", &["null", "0", "0.001", "1e308"]),
        ("min_centres", &["3", "5", "1000", "2", "18446744073709551615"]),
        ("max_centres", &["30", "1000", "3", "1001"]),
        ("path_rings", &["0", "2", "64", "65", "4294967296"]),
        ("deadline_us", &["1", "1000000", "18446744073709551615", "null", "0"]),
        ("thicknes", &["1"]),
    ];
    let mut fields = Vec::new();
    for (name, values) in VALUES {
        if rng.random_bool(0.2) {
            // The last value of each is one that is refused.
            let last = if rng.random_bool(0.9) && values.len() > 1 { values.len() - 1 } else { values.len() };
            fields.push(format!("\"{name}\": {}", values[rng.random_range(0..last)]));
        }
    }
    format!("{{{}}}", fields.join(", ")).into_bytes()
}

fn number(rng: &mut ChaCha8Rng) -> String {
    match rng.random_range(0..20) {
        0 => format!("{}", f64::from_bits(rng.random())),
        1 => format!("{:e}", rng.random_range(-1e9..1e9)),
        _ => format!("{:.3}", rng.random_range(-1.0..1.0)),
    }
}

fn obj(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..4u32);
    let mut text = String::from("# a sheet\nmtllib a.mtl\no sheet\n");
    for _ in 0..(n + 1) * (n + 1) {
        text += &format!("v {} {} {}\n", number(rng), number(rng), number(rng));
    }
    if rng.random() {
        text += "vt 0 0\nvt 1 0\nvt 0 1\n";
    }
    for face in grid(n) {
        let corners = face.map(|corner| match rng.random_range(0..8) {
            0 => format!("{}/1", corner + 1),
            1 => format!("-{}", (n + 1) * (n + 1) - corner),
            2 => format!("{}//1", corner + 1),
            _ => format!("{}", corner + 1),
        });
        text += &format!("f {}{}\n", corners.join(" "), if rng.random_bool(0.1) { " 1" } else { "" });
    }
    text.into_bytes()
}

fn ply(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let n = rng.random_range(1..4u32);
    let faces = grid(n);
    let (kind, big) =
        [("ascii", false), ("binary_little_endian", false), ("binary_big_endian", true)][rng.random_range(0..3)];
    let double = rng.random::<bool>();
    let float = if double { "double" } else { "float" };
    let mut bytes = format!(
        "ply\nformat {kind} 1.0\ncomment a sheet\nelement vertex {}\nproperty {float} x\nproperty {float} y\nproperty {float} z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        (n + 1) * (n + 1),
        faces.len()
    )
    .into_bytes();
    for _ in 0..(n + 1) * (n + 1) {
        if kind == "ascii" {
            bytes.extend(format!("{} {} {}\n", number(rng), number(rng), number(rng)).into_bytes());
        } else {
            for _ in 0..3 {
                let value: f64 = number(rng).parse().unwrap_or(0.0);
                let mut word =
                    if double { value.to_le_bytes().to_vec() } else { (value as f32).to_le_bytes().to_vec() };
                if big {
                    word.reverse();
                }
                bytes.extend(word);
            }
        }
    }
    for face in faces {
        if kind == "ascii" {
            bytes.extend(format!("3 {} {} {}\n", face[0], face[1], face[2]).into_bytes());
        } else {
            bytes.push(3);
            bytes.extend(face.iter().flat_map(|i| if big { i.to_be_bytes() } else { i.to_le_bytes() }));
        }
    }
    bytes
}

fn gltf(rng: &mut ChaCha8Rng, binary: bool) -> Vec<u8> {
    let n = rng.random_range(1..3u32);
    let (num_vertices, faces) = ((n + 1) * (n + 1), grid(n));
    let mut data: Vec<u8> = Vec::new();
    for _ in 0..num_vertices * 3 {
        data.extend(number(rng).parse().unwrap_or(0.0f32).to_le_bytes());
    }
    let positions = data.len();
    data.extend(faces.iter().flatten().flat_map(|i| i.to_le_bytes()));
    let indices = data.len() - positions;
    let uri = if binary {
        String::new()
    } else {
        format!("\"uri\":\"data:application/octet-stream;base64,{}\",", base64(&data))
    };
    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\"indices\":1}}]}}],\"buffers\":[{{{uri}\"byteLength\":{}}}],\"bufferViews\":[{{\"buffer\":0,\"byteLength\":{positions}}},{{\"buffer\":0,\"byteOffset\":{positions},\"byteLength\":{indices}}}],\"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":{num_vertices},\"type\":\"VEC3\",\"min\":[-1,-1,-1],\"max\":[1,1,1]}},{{\"bufferView\":1,\"componentType\":5125,\"count\":{},\"type\":\"SCALAR\"}}]}}",
        data.len(),
        3 * faces.len()
    );
    if !binary {
        return json.into_bytes();
    }
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + data.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend([2u32, total as u32, json.len() as u32].iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k)) as usize & 63];
            text.push(if k <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}
