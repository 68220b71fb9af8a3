use faer::{
    dyn_stack::{MemBuffer, MemStack},
    sparse::{
        SymbolicSparseColMatRef,
        linalg::amd::{Control, order_maybe_unsorted, order_maybe_unsorted_scratch},
    },
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::MinimumDegree;
use crate::correspond::{Cholesky, SparseSymmetric};

/// The pattern of a graph, with the diagonal.
fn pattern(size: usize, edges: impl IntoIterator<Item = [usize; 2]>) -> SparseSymmetric {
    let mut matrix = SparseSymmetric::default();
    matrix.start(size);
    for at in 0..size {
        matrix.add(at, at, 1.0);
    }
    for [a, b] in edges {
        matrix.add(a, b, 0.0);
        matrix.add(b, a, 0.0);
    }
    matrix.compress();
    matrix
}

/// A grid with its diagonals, its rows in random order; `is_in` says which of its vertices there are.
fn sheet(columns: usize, rows: usize, seed: u64, is_in: impl Fn(usize, usize) -> bool) -> SparseSymmetric {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut places = vec![usize::MAX; columns * rows];
    let mut kept: Vec<usize> = (0..columns * rows).filter(|at| is_in(at % columns, at / columns)).collect();
    for last in (1..kept.len()).rev() {
        kept.swap(last, rng.random_range(0..=last));
    }
    for (place, &at) in kept.iter().enumerate() {
        places[at] = place;
    }
    let mut edges = Vec::new();
    for &at in &kept {
        let (x, y) = (at % columns, at / columns);
        let is_odd = rng.random_range(0..2) == 0;
        let [down, across] = if is_odd { [columns, columns + 1] } else { [columns, columns - 1] };
        let has_across = if is_odd { x + 1 < columns } else { x > 0 };
        let others = [(x + 1 < columns, 1), (y + 1 < rows, down), (y + 1 < rows && has_across, across)];
        edges.extend(others.iter().filter(|other| other.0).map(|&(_, step)| [at, at + step]));
    }
    let edges = edges.into_iter().map(|edge| edge.map(|at| places[at]));
    pattern(kept.len(), edges.filter(|edge| edge.iter().all(|&place| place != usize::MAX)))
}

fn order(matrix: &SparseSymmetric, memory: &mut MinimumDegree) -> Vec<usize> {
    let mut order = Vec::new();
    memory.find(&matrix.starts, &matrix.rows, &mut order);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..matrix.size()), "each row once");
    order
}

/// That of a library.
fn order_by_faer(matrix: &SparseSymmetric) -> Vec<usize> {
    let (size, SparseSymmetric { starts, rows, .. }) = (matrix.size(), matrix);
    let pattern = SymbolicSparseColMatRef::new_unsorted_checked(size, size, starts, None, rows);
    let (mut order, mut place) = (vec![0; size], vec![0; size]);
    let mut buffer = MemBuffer::new(order_maybe_unsorted_scratch::<usize>(size, rows.len()));
    let stack = MemStack::new(&mut buffer);
    order_maybe_unsorted(&mut order, &mut place, pattern, Control::default(), stack).unwrap();
    order
}

fn fill(matrix: &SparseSymmetric, order: &[usize]) -> usize {
    let mut factor = Cholesky::default();
    factor.set_order(order.iter().copied());
    factor.grow_tree(matrix);
    factor.num_entries()
}

#[test]
fn minimum_degree_of_sheets_fills_no_more_than_that_of_a_library() {
    let mut memory = MinimumDegree::default();
    let mut sums = [0; 2];
    for seed in 0..40 {
        let size = 6 + usize::try_from(seed).unwrap();
        let hole =
            |x: usize, y: usize| x.abs_diff(size / 2) + y.abs_diff(size / 2) > usize::try_from(seed % 5).unwrap();
        for matrix in [sheet(size, size, seed, |_, _| true), sheet(3 * size, size, seed, hole)] {
            let fills = [order(&matrix, &mut memory), order_by_faer(&matrix)].map(|order| fill(&matrix, &order));
            assert!((fills[0] as f64) < 1.3 * fills[1] as f64, "{fills:?} of {size}");
            sums = [sums[0] + fills[0], sums[1] + fills[1]];
        }
    }
    assert!(sums[0] as f64 <= 1.1 * sums[1] as f64, "{sums:?}");
}

#[test]
fn minimum_degree_of_a_tree_and_of_a_star_fills_nothing() {
    let mut memory = MinimumDegree::default();
    let tree = pattern(1000, (1..1000).map(|at| [at, at / 2]));
    assert_eq!(fill(&tree, &order(&tree, &mut memory)), 1000 + 999);
    // The centre is too dense to take part, and goes last.
    let star = pattern(1000, (0..1000).filter(|&at| at != 7).map(|at| [at, 7]));
    let order = order(&star, &mut memory);
    assert_eq!((fill(&star, &order), order[999]), (1000 + 999, 7));
}

#[test]
fn minimum_degree_of_cliques_without_edges_between_fills_nothing_and_does_not_mix_them() {
    let edges = (0..60).flat_map(|a| (0..a).filter(move |b| a % 6 == b % 6).map(move |b| [a, b]));
    let matrix = pattern(60, edges);
    let order = order(&matrix, &mut MinimumDegree::default());
    assert_eq!(fill(&matrix, &order), 6 * (10 * 11 / 2));
    assert!(order.chunks(10).all(|rows| rows.iter().all(|row| row % 6 == rows[0] % 6)));
}

#[test]
fn minimum_degree_of_random_graphs_has_each_row_once_and_is_the_same_from_kept_memory() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut memory = MinimumDegree::default();
    for size in 0..120 {
        let num_edges = rng.random_range(0..=3 * size);
        let edges: Vec<_> = (0..num_edges).map(|_| [rng.random_range(0..size), rng.random_range(0..size)]).collect();
        let edges = edges.into_iter().filter(|[a, b]| a != b);
        let matrix = pattern(size, edges);
        assert_eq!(order(&matrix, &mut memory), order(&matrix, &mut MinimumDegree::default()));
    }
}
