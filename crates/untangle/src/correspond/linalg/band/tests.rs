//! Strips, sheets, and what is not definite.

use nalgebra::{Complex, ComplexField};

use super::{
    matrix::{BandMatrix, Entry},
    shape::Band,
};

/// The triangles of a strip of squares, with rows of so many vertices.
fn strip(width: u32, length: u32) -> Vec<[u32; 3]> {
    let squares = (0..length - 1).flat_map(|row| (0..width - 1).map(move |column| row * width + column));
    squares.flat_map(|a| [[a, a + 1, a + width], [a + width, a + 1, a + width + 1]]).collect()
}

/// Solves for known unknowns, and returns by how much the solution misses them.
fn miss<T: Entry>(triangles: &[[u32; 3]], count: usize, weight: T) -> f64 {
    let mut band = Band::default();
    assert!(band.find(count, 0, triangles.iter().copied()));
    let mut matrix = BandMatrix::default();
    matrix.start(&band);
    let wanted: Vec<_> = (0..count).map(|k| Complex::new((k as f64).sin(), 0.1 * k as f64)).collect();
    let mut unknowns = vec![Complex::new(0.0, 0.0); count];
    let mut add = |row: usize, column: usize, value: T| {
        let [row, column] = [row, column].map(|vertex| band.places()[vertex]);
        matrix.add(&band, row, column, value);
        unknowns[row] += value.times(wanted[column]);
        if row != column {
            unknowns[column] += value.conjugate().times(wanted[row]);
        }
    };
    for vertex in 0..count {
        add(vertex, vertex, T::from_real(0.01));
    }
    for &[a, b, c] in triangles {
        for [a, b] in [[a, b], [b, c], [c, a]].map(|ends| ends.map(|end| end as usize)) {
            add(a, a, T::from_real(weight.norm1()));
            add(b, b, T::from_real(weight.norm1()));
            add(a, b, weight);
        }
    }
    assert!(matrix.factorise(&band));
    matrix.solve(&band, &mut unknowns);
    (0..count).map(|k| (unknowns[k] - wanted[k]).norm1()).fold(0.0, f64::max)
}

#[test]
fn band_of_strips_with_vertices_of_no_triangle_solves_for_real_and_complex_entries() {
    for (width, length) in [(2, 2), (3, 40), (9, 9)] {
        let triangles = strip(width, length);
        let count = (width * length + 2) as usize;
        assert!(miss(&triangles, count, -1.0) < 1e-9);
        assert!(miss(&triangles, count, Complex::new(0.4, -0.5)) < 1e-9);
    }
}

#[test]
fn band_of_a_wide_sheet_is_not_narrow_and_that_of_a_long_strip_is() {
    let mut band = Band::default();
    assert!(!band.find(100 * 100, 0, strip(100, 100).into_iter()));
    assert!(band.find(10 * 1000, 0, strip(10, 1000).into_iter()));
    assert!(band.lengths.iter().all(|&length| length < 24));
}

#[test]
fn band_of_indefinite_matrix_fails() {
    let mut band = Band::default();
    assert!(band.find(3, 0, [[0, 1, 2]].into_iter()));
    let mut matrix = BandMatrix::default();
    matrix.start(&band);
    for row in 0..3 {
        matrix.add(&band, row, row, 1.0);
        matrix.add(&band, row, (row + 1) % 3, 2.0);
    }
    assert!(!matrix.factorise(&band));
}
