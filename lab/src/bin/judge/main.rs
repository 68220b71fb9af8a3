//! Holds intersections and gaps against a judge in rational numbers, for random small meshes of every degenerate kind,
//! until so many pairs of faces of each kind are compared.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin judge                       # a million pairs in all
//! cargo run --release -p untangled-lab --bin judge -- --pairs 10000000 --from 1000000000
//! cargo run --release -p untangled-lab --bin judge -- --portable         # without AVX2
//! cargo run --release -p untangled-lab --bin judge -- --kind 3 --from 17 --pairs 1   # one mesh again
//! ```
//!
//! Prints a row for each kind, and every difference with the seed of its mesh; with one it ends in failure.

#![allow(clippy::print_stdout, reason = "prints a table")]

use std::process::ExitCode;

use rayon::prelude::*;
use untangle::simd::use_portable_instructions;
use untangled_lab::table::print_header;
use untangled_testkit::{
    generate::degenerate::small::KINDS,
    judge::rational::{Comparison, compare_random},
};

/// Meshes between two looks at how many pairs there are.
const BATCH: u64 = 256;

struct Options {
    pairs: usize,
    from: u64,
    kind: Option<usize>,
}

fn options() -> Options {
    let mut options = Options { pairs: 1_000_000, from: 0, kind: None };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || {
            arguments
                .next()
                .and_then(|number| number.parse::<u64>().ok())
                .unwrap_or_else(|| panic!("{argument} takes a number"))
        };
        match argument.as_str() {
            "--portable" => use_portable_instructions(true),
            "--pairs" => options.pairs = usize::try_from(number()).unwrap_or(usize::MAX),
            "--from" => options.from = number(),
            "--kind" => options.kind = usize::try_from(number()).ok(),
            _ => panic!("{argument} is none of --pairs, --from, --kind, --portable"),
        }
    }
    options
}

fn main() -> ExitCode {
    let Options { pairs, from, kind } = options();
    let kinds: Vec<usize> = kind.map_or_else(|| (0..KINDS.len()).collect(), |kind| vec![kind]);
    let pairs_per_kind = pairs.div_ceil(kinds.len());
    print_header(&[
        "kind",
        "meshes",
        "frames refused",
        "pairs of faces",
        "intersect",
        "signs",
        "pairs of primitives",
        "decisions at a distance",
        "nearer",
        "largest error of a distance (2^-53 of the extent)",
        "edges and faces, by the checker",
        "differences",
    ]);
    let mut num_differences = 0;
    for kind in kinds {
        num_differences += print_kind(kind, from, pairs_per_kind);
    }
    if num_differences > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Compares meshes of a kind until there are so many pairs of faces, and prints the row; the number of differences.
fn print_kind(kind: usize, from: u64, pairs: usize) -> usize {
    let (mut all, mut num_meshes, mut differences) = (Comparison::default(), 0, Vec::new());
    while all.intersections.num_pairs < pairs && differences.len() < 10 {
        let first = from + num_meshes;
        let batch = if pairs == 1 { 1 } else { BATCH };
        let results: Vec<_> = (first..first + batch).into_par_iter().map(|seed| compare_random(kind, seed)).collect();
        num_meshes += batch;
        for result in results {
            match result {
                Ok(one) => all.add(&one),
                Err(words) => differences.push(words),
            }
        }
    }
    let Comparison { intersections, gaps, checker } = all;
    println!(
        "| {} | {num_meshes} | {} | {} | {} | {} | {} | {} | {} | {:.1} | {} | {} |",
        KINDS[kind],
        intersections.num_refused,
        intersections.num_pairs,
        intersections.num_positive,
        intersections.num_decisions,
        gaps.num_pairs,
        gaps.num_decisions,
        gaps.num_positive,
        gaps.largest_error,
        checker.num_pairs,
        differences.len(),
    );
    for words in &differences {
        println!("\n{words}\n");
    }
    differences.len()
}
