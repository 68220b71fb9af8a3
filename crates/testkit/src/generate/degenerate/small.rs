//! Small random meshes in which nearly everything is degenerate, at every scale that is accepted.

use rand::{RngExt, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;

/// Faces over vertices, some of which may be those of bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallMesh {
    /// Of which kind, see [`KINDS`].
    pub kind: usize,
    /// In metres; some may be too large to be accepted.
    pub positions: Vec<[f64; 3]>,
    /// Some may name a vertex twice, or the vertices of another one.
    pub faces: Vec<[u32; 3]>,
    /// The vertices of bodies, ascending.
    pub body: Vec<u32>,
}

/// How the vertices of each kind lie.
pub const KINDS: [&str; 8] = [
    "anywhere",
    "on a grid of two to four steps",
    "in one plane but for rounding",
    "on vertices, edges and faces of others",
    "on a line, in a plane or in one point, exactly",
    "units in the last place from a grid",
    "the least and the greatest numbers, denormals, zeros of both signs",
    "sheets of up to 42 vertices, crumpled",
];

/// Most vertices.
const MAX_VERTICES: usize = 42;

impl SmallMesh {
    /// A mesh of a kind.
    pub fn random(rng: &mut ChaCha8Rng, kind: usize) -> Self {
        let (mut positions, faces, body) = if kind == 7 {
            let (positions, faces) = sheet(rng);
            (positions, faces, Vec::new())
        } else {
            let positions = places(rng, kind);
            let (faces, body) = faces(rng, positions.len() as u32);
            (positions, faces, body)
        };
        if kind != 6 {
            rescale(rng, &mut positions);
        }
        Self { kind, positions, faces, body }
    }

    /// The positions of the next frame: most where they were, some a little farther, some in the place of others.
    pub fn moved(&self, rng: &mut ChaCha8Rng) -> Vec<[f64; 3]> {
        let extent = self.positions.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
        let step = extent * [0.0, 1e-9, 1e-4, 1e-2][rng.random_range(0..4)];
        let shared: [f64; 3] = std::array::from_fn(|_| step * f64::from(rng.random_range(-1..2)));
        let mut moved = self.positions.clone();
        for place in &mut moved {
            match rng.random_range(0..8) {
                0 => *place = *self.positions.choose(rng).unwrap(),
                1 | 2 => *place = place.map(|value| value + step * rng.random_range(-1.0..1.0)),
                _ => {}
            }
            for (value, shared) in place.iter_mut().zip(shared) {
                *value += shared;
            }
        }
        moved
    }
}

/// Positions of a few vertices.
fn places(rng: &mut ChaCha8Rng, kind: usize) -> Vec<[f64; 3]> {
    let count = rng.random_range(4..15);
    let steps = rng.random_range(2..5);
    let grid = |rng: &mut ChaCha8Rng| -> [f64; 3] { std::array::from_fn(|_| f64::from(rng.random_range(0..steps))) };
    let unit = |rng: &mut ChaCha8Rng| -> [f64; 3] { std::array::from_fn(|_| rng.random_range(-1.0..1.0)) };
    let base = [unit(rng), unit(rng), unit(rng)];
    let whole = [grid(rng), grid(rng), grid(rng)];
    let dimensions = rng.random_range(0..3);
    let mut places: Vec<[f64; 3]> = Vec::new();
    for _ in 0..count {
        let place = match kind {
            0 => unit(rng),
            1 => grid(rng),
            2 => combined(base, [1.0, rng.random_range(-2.0..2.0), rng.random_range(-2.0..2.0)]),
            3 => on_others(rng, &places, grid),
            4 => {
                let mut weight =
                    |from: usize| if from <= dimensions { f64::from(rng.random_range(-3..4)) } else { 0.0 };
                combined(whole, [1.0, weight(1), weight(2)])
            }
            5 => grid(rng).map(|value| nudged(rng, value)),
            _ => std::array::from_fn(|_| extreme(rng)),
        };
        places.push(place);
    }
    places
}

/// A sum of points with weights.
fn combined(points: [[f64; 3]; 3], weights: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| (0..3).map(|k| points[k][axis] * weights[k]).sum())
}

/// A place on a vertex, an edge, its line, or a face of places before it; exactly, as their coordinates are small.
fn on_others(
    rng: &mut ChaCha8Rng,
    places: &[[f64; 3]],
    mut other: impl FnMut(&mut ChaCha8Rng) -> [f64; 3],
) -> [f64; 3] {
    if places.len() < 3 || rng.random_bool(0.2) {
        return other(rng);
    }
    let three = std::array::from_fn(|_| *places.choose(rng).unwrap());
    let weights = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.75, 0.25, 0.0], [2.0, -1.0, 0.0], [0.5, 0.25, 0.25]];
    let place = combined(three, *weights.choose(rng).unwrap());
    // Halves of halves run out of bits after some fifty.
    if rng.random_bool(0.1) { place.map(|value| nudged(rng, value)) } else { place }
}

/// A number a few units in the last place away.
fn nudged(rng: &mut ChaCha8Rng, value: f64) -> f64 {
    match rng.random_range(0..6) {
        0 => value.next_up(),
        1 => value.next_down(),
        2 => value * (1.0 + 2.0 * f64::EPSILON),
        _ => value,
    }
}

/// The numbers at the ends of what is accepted, and beyond.
fn extreme(rng: &mut ChaCha8Rng) -> f64 {
    let least = 2f64.powi(-250);
    let most = 2f64.powi(250);
    let numbers = [
        0.0,
        -0.0,
        least,
        least * 1.5,
        least.next_down(),
        least.next_up(),
        f64::from_bits(1),
        -f64::MIN_POSITIVE,
        1e-30,
    ];
    let large = [1.0, -1.0, 1.0 + f64::EPSILON, 1e30, most, -most, most.next_down(), 2f64.powi(249)];
    match rng.random_range(0..1000) {
        // One of these is enough for a frame to be refused.
        0 => *[most.next_up(), f64::INFINITY, f64::NAN, f64::MAX].choose(rng).unwrap(),
        1..500 => *numbers.choose(rng).unwrap(),
        500..900 => *large.choose(rng).unwrap(),
        _ => rng.random_range(-1.0..1.0) * 2f64.powi(rng.random_range(-250..250)),
    }
}

/// Faces over so many vertices: any three, neighbours of others, fans; and the vertices of bodies.
fn faces(rng: &mut ChaCha8Rng, count: u32) -> (Vec<[u32; 3]>, Vec<u32>) {
    let split = if count >= 8 && rng.random_bool(0.2) { rng.random_range(4..=count - 4) } else { 0 };
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for _ in 0..rng.random_range(2..11) {
        let part = if rng.random_range(0..count) < split { 0..split } else { split..count };
        let vertex = |rng: &mut ChaCha8Rng| rng.random_range(part.clone());
        let mut face = [vertex(rng), vertex(rng), vertex(rng)];
        if let Some(before) = faces.last().filter(|before| part.contains(&before[0]))
            && rng.random_bool(0.4)
        {
            // Beside the face before it, so that fans and strips come about.
            face = [before[0], before[2], face[2]];
        }
        let is_proper = face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
        if is_proper || rng.random_bool(0.05) {
            faces.push(face);
        }
    }
    // At least one that is no line.
    faces.push([count - 1, count - 2, count - 3]);
    (faces, (0..split).collect())
}

/// A sheet of two to six by two to seven vertices, smooth, crumpled or folded flat, over itself now and then.
fn sheet(rng: &mut ChaCha8Rng) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (rows, columns) = (rng.random_range(2..7u32), rng.random_range(2..8u32));
    debug_assert!((rows * columns) as usize <= MAX_VERTICES);
    let height = [0.0, 0.01, 0.3, 3.0][rng.random_range(0..4)];
    let is_folded = rng.random_bool(0.3);
    let mut positions = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [x, y] = [f64::from(row), f64::from(column)];
            let z = height * rng.random_range(-1.0..1.0);
            let x = if is_folded { (x - 2.0).abs() } else { x };
            positions.push([x + 0.3 * height * rng.random_range(-1.0..1.0), y, z]);
        }
    }
    let corner = |row: u32, column: u32| row * columns + column;
    let squares = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column)));
    let faces = squares
        .flat_map(|(i, k)| {
            let [a, b, c, d] = [corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    (positions, faces)
}

/// Another shape, another size, another place, single precision.
fn rescale(rng: &mut ChaCha8Rng, positions: &mut [[f64; 3]]) {
    let factor = match rng.random_range(0..6) {
        0 => 2f64.powi(rng.random_range(-245..245)),
        1 => 10f64.powi(rng.random_range(-70..70)),
        2 => rng.random_range(1e-3..1e3),
        _ => 1.0,
    };
    let offset = if rng.random_bool(0.2) { factor * 10f64.powi(rng.random_range(0..12)) } else { 0.0 };
    // Slivers along a line, or all next to a plane.
    let thinness = if rng.random_bool(0.2) { 10f64.powi(-rng.random_range(1..15)) } else { 1.0 };
    let first_thin = rng.random_range(1..3);
    for place in positions.iter_mut() {
        place[first_thin..].iter_mut().for_each(|value| *value *= thinness);
    }
    let is_single = rng.random_bool(0.1);
    for value in positions.iter_mut().flatten() {
        *value = *value * factor + offset;
        if is_single {
            *value = f64::from(*value as f32);
        }
    }
}
