//! Crumpled sheets: a flat sheet under a random smooth displacement that grows until it intersects itself.

use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;
use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription, Uvs},
};

/// A sheet as a caller would hand it over.
#[derive(Clone)]
pub(crate) struct Sheet {
    pub(crate) faces: Vec<[u32; 3]>,
    /// One for each vertex.
    pub(crate) uvs: Vec<[f64; 2]>,
    pub(crate) positions: Vec<[f64; 3]>,
}

impl Sheet {
    pub(crate) fn mesh(&self) -> Mesh {
        let uvs = Some(Uvs { coordinates: self.uvs.clone(), corners: self.faces.clone() });
        let description =
            MeshDescription { num_vertices: self.uvs.len(), faces: self.faces.clone(), uvs, ..Default::default() };
        Mesh::new(description).unwrap()
    }

    /// The mesh without texture coordinates: discs are measured by the lengths of its edges.
    pub(crate) fn bare_mesh(&self) -> Mesh {
        let description =
            MeshDescription { num_vertices: self.uvs.len(), faces: self.faces.clone(), ..Default::default() };
        Mesh::new(description).unwrap()
    }

    pub(crate) fn frame(&self, mesh: &Mesh) -> Frame {
        Frame::new(mesh, &self.positions).unwrap()
    }
}

/// One wave of the displacement.
struct Wave {
    direction: [f64; 3],
    frequency: [f64; 2],
    phase: f64,
}

/// A sheet of `resolution x resolution` squares of side 1 / `resolution` metres that has just begun to intersect itself, or somewhat later.
/// The same seed gives the same sheet.
pub(crate) fn crumpled(seed: u64, resolution: u32) -> Sheet {
    crumpled_further(seed, resolution, 1.5, 0)
}

/// The same with waves of up to `frequency` over the sheet, and so many steps further than the first contact.
pub(crate) fn crumpled_further(seed: u64, resolution: u32, frequency: f64, further: u32) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (faces, uvs) = grid(resolution, &mut rng);
    let waves: Vec<Wave> = (0..6)
        .map(|_| Wave {
            direction: std::array::from_fn(|_| rng.random_range(-1.0..1.0)),
            frequency: std::array::from_fn(|_| rng.random_range(-frequency..frequency)),
            phase: rng.random_range(0.0..std::f64::consts::TAU),
        })
        .collect();
    let mut sheet = Sheet { faces, uvs, positions: Vec::new() };
    let mesh = sheet.mesh();
    let mut amplitude = 0.1;
    let (mut found, mut intersector) = (Intersections::default(), Intersector::default());
    // A little beyond the first contact, so that more than one type of path is met.
    let mut steps_beyond = rng.random_range(1..5) + further;
    while steps_beyond > 0 {
        amplitude *= 1.15;
        assert!(amplitude < 1e3, "seed {seed} never intersects itself");
        sheet.positions = sheet.uvs.iter().map(|&uv| displaced(uv, &waves, amplitude)).collect();
        intersector.intersect(&mesh, &sheet.frame(&mesh), &mut found);
        if !found.segments.is_empty() {
            steps_beyond -= 1;
        }
    }
    sheet
}

/// Squares with diagonals of random direction.
pub(crate) fn grid(resolution: u32, rng: &mut ChaCha8Rng) -> (Vec<[u32; 3]>, Vec<[f64; 2]>) {
    let step = 1.0 / f64::from(resolution);
    let row = resolution + 1;
    let uvs = (0..row * row).map(|k| [f64::from(k % row) * step, f64::from(k / row) * step]).collect();
    let mut faces = Vec::new();
    for y in 0..resolution {
        for x in 0..resolution {
            let [a, b, c, d] = [y * row + x, y * row + x + 1, (y + 1) * row + x + 1, (y + 1) * row + x];
            faces.extend(if rng.random() { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    (faces, uvs)
}

fn displaced([u, v]: [f64; 2], waves: &[Wave], amplitude: f64) -> [f64; 3] {
    let mut position = [u, v, 0.0];
    for wave in waves {
        let angle = std::f64::consts::TAU * (wave.frequency[0] * u + wave.frequency[1] * v) + wave.phase;
        for (coordinate, direction) in position.iter_mut().zip(wave.direction) {
            *coordinate += amplitude * direction * angle.sin();
        }
    }
    position
}

/// The same sheet under other names.
#[derive(Clone)]
pub(crate) struct Relabelled {
    pub(crate) sheet: Sheet,
    /// New name of each old vertex.
    pub(crate) vertex: Vec<u32>,
    /// New name of each old face.
    pub(crate) face: Vec<u32>,
}

impl Relabelled {
    /// Old names of vertices and faces.
    pub(crate) fn old_names(&self) -> [Vec<u32>; 2] {
        [&self.vertex, &self.face].map(|names| {
            let mut old = vec![0; names.len()];
            for (name, &new) in (0..).zip(names) {
                old[new as usize] = name;
            }
            old
        })
    }
}

/// Permutes vertices and faces, rotates corners, and turns all faces over if asked to.
pub(crate) fn relabelled(sheet: &Sheet, seed: u64, turn_over: bool) -> Relabelled {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let vertex = permutation(sheet.positions.len(), &mut rng);
    with_names(sheet, vertex, &mut rng, |_| turn_over)
}

/// Permutes faces, rotates corners, and turns about every second face over; vertices keep their names.
pub(crate) fn reordered(sheet: &Sheet, seed: u64) -> Relabelled {
    let vertex = (0..u32::try_from(sheet.positions.len()).unwrap()).collect();
    with_names(sheet, vertex, &mut ChaCha8Rng::seed_from_u64(seed), |rng| rng.random())
}

fn permutation(count: usize, rng: &mut ChaCha8Rng) -> Vec<u32> {
    let mut names: Vec<u32> = (0..u32::try_from(count).unwrap()).collect();
    names.shuffle(rng);
    names
}

fn with_names(
    sheet: &Sheet,
    vertex: Vec<u32>,
    rng: &mut ChaCha8Rng,
    turn_over: impl Fn(&mut ChaCha8Rng) -> bool,
) -> Relabelled {
    let face = permutation(sheet.faces.len(), rng);
    let mut other = sheet.clone();
    for (old, &new) in vertex.iter().enumerate() {
        other.positions[new as usize] = sheet.positions[old];
        other.uvs[new as usize] = sheet.uvs[old];
    }
    for (old, &new) in face.iter().enumerate() {
        let mut corners = sheet.faces[old].map(|corner| vertex[corner as usize]);
        corners.rotate_left(rng.random_range(0..3));
        if turn_over(rng) {
            corners.swap(1, 2);
        }
        other.faces[new as usize] = corners;
    }
    Relabelled { sheet: other, vertex, face }
}
