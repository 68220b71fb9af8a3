//! Requests that are valid more often than not.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use untangled_proto::{
    RegisterParams,
    sections::{SectionWriter, id},
};

use super::grid::grid;

/// Settings, each with some values; the last of several is refused.
const VALUES: [(&str, &[&str]); 15] = [
    ("quality", &["\"fast\"", "\"balanced\"", "\"accurate\"", "\"best\""]),
    ("response", &["\"rbf\"", "\"contour\"", "\"displacement\"", "\"mask\"", "1"]),
    ("inside", &["\"count\"", "\"area\"", "\"work\"", "null"]),
    ("layer_order", &["true", "false"]),
    ("winding", &["true", "false"]),
    ("pinned_outside", &["true", "false", "0"]),
    ("stiffness_per_step2", &["0", "0.5", "1e300", "5e-324", "-1"]),
    ("max_step_edge_lengths", &["0", "0.2", "1e308", "1e400"]),
    ("steps_to_clean", &["1", "3", "1e308", "0.5"]),
    ("thickness_m", &["null", "0", "0.001", "1e308"]),
    ("min_centres", &["3", "5", "1000", "2", "18446744073709551615"]),
    ("max_centres", &["30", "1000", "3", "1001"]),
    ("path_rings", &["0", "2", "64", "65", "4294967296"]),
    ("deadline_us", &["1", "1000000", "18446744073709551615", "null", "0"]),
    ("thicknes", &["1"]),
];

/// A registration that is valid more often than not.
pub(in crate::fuzz) fn registration(rng: &mut ChaCha8Rng) -> (Vec<u8>, u32) {
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
pub(in crate::fuzz) fn document(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut fields = Vec::new();
    for (name, values) in VALUES {
        if rng.random_bool(0.2) {
            let last = if rng.random_bool(0.9) && values.len() > 1 { values.len() - 1 } else { values.len() };
            fields.push(format!("\"{name}\": {}", values[rng.random_range(0..last)]));
        }
    }
    format!("{{{}}}", fields.join(", ")).into_bytes()
}
