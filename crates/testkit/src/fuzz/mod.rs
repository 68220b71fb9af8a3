//! A seeded random fuzzer for everything that reads bytes from outside.
//!
//! An input is a valid one with some damage, or noise; the same seed and number give the same input. Each input must be
//! refused with an error in words or hold the invariants of what was accepted. A panic is a find, which names seed and
//! number. [`bytes`] has the same readers for a fuzzer that coverage guides, and for tests of what it found.

pub mod bytes;
mod checks;
mod fuzzer;
mod inputs;

use std::panic::{AssertUnwindSafe, catch_unwind};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use fuzzer::Fuzzer;

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
    /// Stages of USD.
    Stage,
}

/// Tries inputs `first..first + count` of a seed; returns how many were accepted.
///
/// # Errors
/// The first find, in words.
pub fn run(target: Target, seed: u64, first: u64, count: u64) -> Result<u64, String> {
    let mut fuzzer = Fuzzer::new();
    let mut num_accepted = 0;
    for input in first..first + count {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ input.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let tried = catch_unwind(AssertUnwindSafe(|| match target {
            Target::Ingest => fuzzer.ingest(&mut rng),
            Target::Register => fuzzer.register(&mut rng),
            Target::Settings => fuzzer.settings(&mut rng),
            Target::MeshFile => Fuzzer::mesh_file(&mut rng),
            Target::Stage => Fuzzer::stage(&mut rng),
        }));
        match tried {
            Ok(accepted) => num_accepted += u64::from(accepted),
            Err(_) => return Err(format!("{target:?}: input {input} of seed {seed} panicked (see above)")),
        }
    }
    Ok(num_accepted)
}
