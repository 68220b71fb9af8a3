//! The same sheet under other names of vertices and faces.

use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use super::Sheet;

/// A sheet whose vertices and faces have new names.
#[derive(Clone, Debug)]
pub struct Relabelled {
    /// The sheet under its new names.
    pub sheet: Sheet,
    /// New name of each old vertex.
    pub vertex: Vec<u32>,
    /// New name of each old face.
    pub face: Vec<u32>,
}

impl Relabelled {
    /// Old names of vertices and faces.
    pub fn old_names(&self) -> [Vec<u32>; 2] {
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
pub fn relabelled(sheet: &Sheet, seed: u64, turn_over: bool) -> Relabelled {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let vertex = permutation(sheet.positions.len(), &mut rng);
    with_names(sheet, vertex, &mut rng, |_| turn_over)
}

/// Permutes faces, rotates corners, and turns about every second face over; vertices keep their names.
pub fn reordered(sheet: &Sheet, seed: u64) -> Relabelled {
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
