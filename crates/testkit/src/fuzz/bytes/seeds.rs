//! What a guided fuzzer begins with: small, made here, much of it accepted.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use untangled_proto::{
    VertexEntry,
    paths::{PathPoint, PathRecord},
    view::InsideEntry,
};

use super::{
    caches::NUM_VERTICES,
    clouds::{Cloud, corner},
};
use crate::{
    fuzz::inputs::{grid::grid, mesh_files, requests, stages},
    generate::Sheet,
    shots,
};

/// Inputs of a generator that takes chances.
fn some(count: u64, make: impl Fn(&mut ChaCha8Rng) -> Vec<u8>) -> Vec<Vec<u8>> {
    (0..count).map(|seed| make(&mut ChaCha8Rng::seed_from_u64(seed))).collect()
}

pub(super) fn obj() -> Vec<Vec<u8>> {
    let mut all = some(6, mesh_files::obj);
    all.push(
        b"o a b\r\nv 0 0 0 1 0.5 0.25\nv 1 0 0\\\n\nv 1 1 0\nv .5 -1e-3 +2.5E1\ng x y\ns off\nf 1 2 3 4\n".to_vec(),
    );
    all.push(
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvt 0 0 0\nusemtl \xc3\xa4\nf -3/1/1 -2/1/1 -1/1/1 # end\nl 1 2\n"
            .to_vec(),
    );
    all
}

pub(super) fn ply() -> Vec<Vec<u8>> {
    let mut all = some(8, mesh_files::ply);
    all.push(
        b"ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 3\r\nproperty uchar red\r\nproperty float32 x\r\n\
          property float32 y\r\nproperty float32 z\r\nelement edge 1\r\nproperty int a\r\nproperty list uint8 float64 w\
          \r\nelement face 1\r\nproperty list uint8 uint16 vertex_index\r\nproperty list uchar float texcoord\r\n\
          end_header\r\n1 0 0 0\r\n2 1 0 0\r\n3 0 1 0\r\n0 2 0.5 1\r\n3 0 1 2 6 0 0 1 0 0 1\r\n"
            .to_vec(),
    );
    all
}

pub(super) fn stl() -> Vec<Vec<u8>> {
    some(8, mesh_files::stl)
}

pub(super) fn gltf() -> Vec<Vec<u8>> {
    let mut all = some(8, |rng| mesh_files::gltf(rng, false));
    all.extend(some(8, |rng| mesh_files::gltf(rng, true)));
    all
}

pub(super) fn usd() -> Vec<Vec<u8>> {
    let mut all = some(16, stages::text);
    all.extend([stages::QUADS_BINARY.to_vec(), stages::QUADS_ARCHIVE.to_vec()]);
    all
}

/// Shots of the four vertices that caches are read over.
fn frames() -> Vec<Sheet> {
    let quad = |frame: u8| Sheet {
        positions: (0..NUM_VERTICES as u8).map(|k| corner(k + frame)).collect(),
        faces: vec![[0, 1, 2], [0, 2, 3]],
        ..Sheet::default()
    };
    (0..3).map(quad).collect()
}

pub(super) fn pc2() -> Vec<Vec<u8>> {
    (1..4).map(|count| shots::pc2(&frames()[..count])).collect()
}

pub(super) fn mdd() -> Vec<Vec<u8>> {
    (1..4).map(|count| shots::mdd(&frames()[..count])).collect()
}

pub(super) fn registrations() -> Vec<Vec<u8>> {
    some(12, |rng| {
        let (payload, num_sections) = requests::registration(rng);
        [vec![num_sections as u8], payload].concat()
    })
}

pub(super) fn settings() -> Vec<Vec<u8>> {
    let mut all = some(12, requests::document);
    all.push(serde_json::to_vec(&untangle::settings::Settings::default()).expect("settings are written"));
    all
}

/// Two sheets that cross, touch, lie in one plane or in one place; a fold; a tetrahedron; faces that are none.
pub(super) fn clouds() -> Vec<Vec<u8>> {
    let square = |at: fn(f64, f64) -> [f64; 3]| [at(-1.0, -1.0), at(1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0)];
    let level = square(|x, y| [x, y, 0.0]);
    let others: [[[f64; 3]; 4]; 6] = [
        square(|x, y| [x, 0.25 * y, y + 0.125]),
        square(|x, y| [x * 0.5, y * 0.5, 0.0]),
        square(|x, y| [x, y, 0.0]),
        square(|x, y| [0.5 * x, 0.0, y + 1.0]),
        square(|x, y| [x + 1.0, x * 0.5 + y, 0.25]),
        square(|x, y| [x * 0.5, y * 0.5, 0.5 - x * x - y]),
    ];
    let one = grid(1);
    let two: Vec<[u32; 3]> = one.iter().copied().chain(one.iter().map(|face| face.map(|corner| corner + 4))).collect();
    let mut all: Vec<_> =
        others.iter().zip(0..).map(|(other, k)| Cloud::bytes(&two, &[level, *other].concat(), 2 * k)).collect();
    all.push(Cloud::bytes(&two, &[level, others[0]].concat(), 8));
    all.push(Cloud::bytes(&grid(2), &(0..9).map(corner).collect::<Vec<_>>(), 2));
    let ends = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2], [4, 5, 6], [4, 4, 5]];
    all.push(Cloud::bytes(&ends, &(0..7).map(corner).collect::<Vec<_>>(), 10));
    all.into_iter().flatten().collect()
}

pub(super) fn corrections() -> Vec<Vec<u8>> {
    let message = |vertices: &[u32], labels: &[[u32; 2]]| {
        let entries =
            vertices.iter().map(|&vertex| VertexEntry { vertex, value: [0.5, -1.0, 0.0], flags: 2 }.to_words());
        let words = entries.flatten().chain(labels.iter().copied().flatten());
        let mut bytes = vec![8, vertices.len() as u8, labels.len() as u8];
        bytes.extend(words.flat_map(u32::to_le_bytes));
        bytes
    };
    vec![
        message(&[], &[]),
        message(&[0, 3, 7], &[]),
        message(&[1, 7], &[[0, 5], [1, 6], [4, 6], [4, 9], [5, u32::MAX], [7, 7]]),
    ]
}

pub(super) fn paths() -> Vec<Vec<u8>> {
    let message = |lengths: &[u32]| {
        let mut bytes = vec![lengths.len() as u8, lengths.iter().sum::<u32>() as u8, 0];
        let mut first_point = 0;
        for (&num_points, partner) in lengths.iter().zip(0..) {
            bytes.extend(PathRecord { partner, first_point, num_points, ..PathRecord::default() }.to_bytes());
            first_point += num_points;
        }
        bytes
            .extend((0..first_point).flat_map(|k| PathPoint { position_m: corner(k as u8), faces: [k, 0] }.to_bytes()));
        bytes
    };
    vec![message(&[]), message(&[2]), message(&[3, 1])]
}

/// Views of three vertices: of a frame that can't be used, a clean one, and one with a pair of paths.
pub(super) fn views() -> Vec<Vec<u8>> {
    let positions: Vec<u8> = (0..9u8).flat_map(|k| f32::from(k).to_le_bytes()).collect();
    let record = |partner| PathRecord { partner, num_points: 2, state: 1, ..PathRecord::default() }.to_bytes();
    let point = |k: u8| PathPoint { position_m: corner(k), faces: [0, 1] }.to_bytes();
    let entry = VertexEntry { vertex: 1, value: [0.5, 0.0, -1.0], flags: 3 }.to_words().map(u32::to_le_bytes);
    let inside = InsideEntry { vertex: 1, pair: 0 }.to_bytes();
    let paths = [record(1), record(0), point(0), point(1)];
    let tangled = [
        &[3, 2, 2, 1, 3, 1, 1],
        paths.as_flattened(),
        entry.as_flattened(),
        &positions,
        &inside,
        &0.25f32.to_le_bytes(),
    ];
    vec![vec![3, 0, 0, 0, 0, 0, 0], [&[3, 0, 0, 0, 3, 0, 0], &positions[..]].concat(), tangled.concat()]
}
