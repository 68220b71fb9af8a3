//! Intersections and gaps against a judge in rational numbers, which follows the text of the manual.
//!
//! The same at a million pairs: `cargo run --release -p untangled-lab --bin judge`.

use untangled_testkit::{
    generate::degenerate::small::KINDS,
    judge::rational::{Comparison, compare_random},
};

/// Meshes of each kind.
const MESHES: u64 = 60;

#[test]
fn answers_of_random_small_meshes_are_those_in_rational_numbers() {
    let mut all = Comparison::default();
    for kind in 0..KINDS.len() {
        // Sheets have many vertices.
        let count = if kind == 7 { MESHES / 10 } else { MESHES };
        for seed in 0..count {
            all.add(&compare_random(kind, seed).unwrap_or_else(|difference| panic!("{difference}")));
        }
    }
    let Comparison { intersections, gaps, checker } = all;
    println!("{all:?}");
    assert!(intersections.num_pairs > 5_000 && intersections.num_positive > 500, "{intersections:?}");
    assert!(gaps.num_decisions > 50_000 && gaps.num_positive > 5_000, "{gaps:?}");
    assert!(checker.num_pairs > 5_000 && checker.num_positive > 500, "{checker:?}");
}
