//! The library and the judge of files, held against the judge in fractions for a random mesh.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    checker::compare_checker,
    library::{Compared, compare_gaps, compare_intersections},
};
use crate::generate::degenerate::small::{KINDS, SmallMesh};

/// Meshes of so many vertices have so many primitives that their distances take seconds.
const MAX_VERTICES_GAPS: usize = 16;

/// What was compared for some meshes, and found alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Intersections of the library, in frames one after the other.
    pub intersections: Compared,
    /// Distances of the library.
    pub gaps: Compared,
    /// Answers of the judge of files.
    pub checker: Compared,
}

impl Comparison {
    /// Both together.
    pub fn add(&mut self, other: &Self) {
        self.intersections.add(&other.intersections);
        self.gaps.add(&other.gaps);
        self.checker.add(&other.checker);
    }
}

/// Compares all answers for the mesh of a kind and a seed; the same seed gives the same mesh.
///
/// # Errors
/// What differs, with the mesh.
pub fn compare_random(kind: usize, seed: u64) -> Result<Comparison, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mesh = SmallMesh::random(&mut rng, kind);
    let _told = Told { kind, seed };
    let mut frames = vec![mesh.positions.clone()];
    for _ in 0..rng.random_range(0..3) {
        frames.push(mesh.moved(&mut rng));
    }
    let words = |what: String| format!("seed {seed}, kind {}: {what}\n{mesh:?}\n{frames:?}", KINDS[kind]);
    let SmallMesh { positions, faces, body, .. } = &mesh;
    let intersections = compare_intersections(faces, body, &frames).map_err(words)?;
    let (mut gaps, mut checker) = (Compared::default(), Compared::default());
    if positions.len() <= MAX_VERTICES_GAPS {
        gaps = compare_gaps(faces, body, positions).map_err(words)?;
        checker = compare_checker(faces, positions).map_err(words)?;
    }
    Ok(Comparison { intersections, gaps, checker })
}

/// Says of which mesh a panic is.
struct Told {
    kind: usize,
    seed: u64,
}

impl Drop for Told {
    fn drop(&mut self) {
        if std::thread::panicking() {
            println!("seed {}, kind {}", self.seed, KINDS[self.kind]);
        }
    }
}
