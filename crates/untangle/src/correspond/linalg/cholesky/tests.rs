use nalgebra::Vector3;

use super::{super::SparseSymmetric, Cholesky};

/// The Laplacian of a grid, a little stiffer than singular, with `extra` added to one entry of the diagonal.
fn laplacian(columns: usize, rows: usize, extra: f64) -> SparseSymmetric {
    let size = columns * rows;
    let mut matrix = SparseSymmetric::default();
    matrix.start(size);
    for at in 0..size {
        matrix.add(at, at, 0.01);
        let mut edge = |a: usize, b: usize| {
            for (row, column, value) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                matrix.add(row, column, value);
            }
        };
        if at % columns + 1 < columns {
            edge(at, at + 1);
        }
        if at + columns < size {
            edge(at, at + columns);
        }
    }
    matrix.add(5, 5, extra);
    matrix.compress();
    matrix
}

fn assert_solves(factor: &mut Cholesky, matrix: &SparseSymmetric) {
    let wanted: Vec<f64> = (0..matrix.size()).map(|at| (at as f64 * 0.37).sin()).collect();
    let mut values = matrix.times(&wanted);
    factor.solve(&mut values);
    for (found, wanted) in values.iter().zip(&wanted) {
        assert!((found - wanted).abs() < 1e-10);
    }
}

#[test]
fn cholesky_of_grid_laplacian_solves() {
    let matrix = laplacian(17, 13, 0.0);
    let mut factor = Cholesky::default();
    assert!(factor.factorise(&matrix));
    assert_solves(&mut factor, &matrix);
}

#[test]
fn cholesky_of_three_right_sides_in_a_given_order_is_that_of_each() {
    let matrix = laplacian(17, 13, 0.0);
    let (mut factor, mut other) = (Cholesky::default(), Cholesky::default());
    assert!(factor.factorise(&matrix));
    assert!(other.factorise_in_order(&matrix, &Cholesky::order_of(&matrix)));
    let vector = |at: usize| Vector3::new((at as f64).sin(), at as f64, 1.0 / (1.0 + at as f64));
    let mut vectors: Vec<_> = (0..matrix.size()).map(vector).collect();
    other.solve_vectors(&mut vectors, &mut Vec::new());
    for axis in 0..3 {
        let mut values: Vec<f64> = (0..matrix.size()).map(|at| vector(at)[axis]).collect();
        factor.solve(&mut values);
        assert!(values.iter().zip(&vectors).all(|(value, all)| value.to_bits() == all[axis].to_bits()));
    }
}

#[test]
fn cholesky_in_pairs_of_blocks_solves() {
    let matrix = laplacian(17, 13, 0.0);
    let (mut factor, mut factor_of_blocks) = (Cholesky::default(), Cholesky::default());
    assert!(factor.factorise(&matrix));
    let mut blocks = matrix.with_blocks();
    blocks.compress();
    assert!(factor_of_blocks.factorise_in_pairs_like(&blocks, &factor));
    assert_solves(&mut factor_of_blocks, &blocks);
}

#[test]
fn cholesky_of_indefinite_matrix_fails_and_its_memory_serves_again() {
    let mut factor = Cholesky::default();
    assert!(!factor.factorise(&laplacian(17, 13, -9.0)));
    let matrix = laplacian(11, 7, 0.0);
    assert!(factor.factorise(&matrix));
    assert_solves(&mut factor, &matrix);
}
