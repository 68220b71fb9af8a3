//! Digests of all answers, to compare two builds bit for bit.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin digests -- FILE... > before.txt
//! ```
//!
//! With `--portable` before them the files are processed without the instructions that not every processor has: the
//! same digests come out.
//!
//! `--generated` prints the digests of generated inputs, which `tests/response/same_bytes/digests.tsv` holds; with
//! `--used` before it by sessions that have seen other frames.
//!
//! An argument names one mesh file, or several joined by `+`, which are pieces in one world. Each world is processed
//! with each response, each quality and each choice of the inside, with one thread and with two, over three
//! frames: the positions of the file, then those with the corrections applied, so that caches kept from frame to frame
//! are used as well. One line for each, fields separated by tabs: the argument, the setting, the number of threads, the
//! digest of the analyses, the digest of the corrections. A digest is FNV-1a (64 bits) over every number, field by
//! field; floating-point numbers count by their bits, so that 0 and -0 differ. A world that is refused gets one line
//! with the error.

#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{error::Error, sync::Arc};

use rayon::{ThreadPool, ThreadPoolBuilder};
use untangle::{
    mesh::Mesh,
    settings::{InsideChoice, Response},
    simd::use_portable_instructions,
};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::judge::digest::{Session, choices, digest_frames, lines, worlds};

/// Largest mesh for which slow settings are not skipped: beyond it, a frame of them can take minutes.
const MAX_FACES_SLOW: usize = 80_000;

/// Errors that may pass from a thread to another.
type BoxedError = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), BoxedError> {
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build());
    let pools = pools.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut session = Session::Fresh;
    for argument in std::env::args().skip(1) {
        if argument == "--portable" {
            use_portable_instructions(true);
            continue;
        }
        if argument == "--used" {
            session = Session::Used;
            continue;
        }
        if argument == "--generated" {
            worlds().iter().flat_map(|world| lines(world, session)).for_each(|line| println!("{line}"));
            continue;
        }
        if let Err(error) = print_world(&argument, &pools) {
            println!("{argument}\trefused\t{error}");
        }
    }
    Ok(())
}

/// Prints the lines of one world.
fn print_world(argument: &str, pools: &[ThreadPool]) -> Result<(), BoxedError> {
    let files = argument.split('+').map(read_mesh).collect::<Result<Vec<_>, _>>()?;
    let world = concatenate(&files)?;
    let mesh = Arc::new(Mesh::new(world.description)?);
    for (name, settings) in choices() {
        let is_slow = settings.response == Response::Coupled || settings.inside == InsideChoice::Work;
        if is_slow && mesh.num_faces() > MAX_FACES_SLOW {
            println!("{argument}\t{name}\tskipped");
            continue;
        }
        for pool in pools {
            let [analyses, corrections] =
                pool.install(|| digest_frames(&mesh, &world.positions, &settings, Session::Fresh))?;
            let threads = pool.current_num_threads();
            println!("{argument}\t{name}\t{threads}\t{:016x}\t{:016x}", analyses.0, corrections.0);
        }
    }
    Ok(())
}
