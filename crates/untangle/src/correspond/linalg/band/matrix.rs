//! Matrices in a band: summed up, factorised, solved.

use nalgebra::{Complex, ComplexField};

use super::shape::{Band, GROUP};
use crate::simd::{InstructionSet, Task, dispatch};

/// An entry of a matrix whose unknowns are complex.
pub(crate) trait Entry: ComplexField<RealField = f64> + Copy {
    /// The product with an unknown.
    fn times(self, unknown: Complex<f64>) -> Complex<f64>;
}

impl Entry for f64 {
    #[inline(always)]
    fn times(self, unknown: Complex<f64>) -> Complex<f64> {
        Complex::new(self * unknown.re, self * unknown.im)
    }
}

impl Entry for Complex<f64> {
    #[inline(always)]
    fn times(self, unknown: Complex<f64>) -> Complex<f64> {
        self * unknown
    }
}

/// A Hermitian matrix in a band, then its factor.
#[derive(Debug)]
pub(crate) struct BandMatrix<T> {
    /// The lower half, column by column.
    values: Vec<T>,
    /// One over each entry of the factor's diagonal.
    inverses: Vec<f64>,
    /// Scratch: the present column below its diagonal.
    column: Vec<T>,
}

impl<T> Default for BandMatrix<T> {
    fn default() -> Self {
        Self { values: Vec::new(), inverses: Vec::new(), column: Vec::new() }
    }
}

impl<T: Entry> BandMatrix<T> {
    /// Begins a matrix of zeros.
    pub(crate) fn start(&mut self, band: &Band) {
        self.values.clear();
        self.values.resize(band.starts[band.lengths.len()], T::zero());
    }

    /// Adds to an entry, and its conjugate to the one across the diagonal. Rows are those of the band.
    #[inline]
    pub(crate) fn add(&mut self, band: &Band, row: usize, column: usize, value: T) {
        if row >= column {
            self.values[band.starts[column] + row - column] += value;
        } else {
            self.values[band.starts[row] + column - row] += value.conjugate();
        }
    }

    /// Factorises the matrix: `A = L L^H`. False where it is not positive definite.
    ///
    /// Cost: for each row the square of the width of the band there.
    pub(crate) fn factorise(&mut self, band: &Band) -> bool {
        let mut is_definite = false;
        dispatch(Factorise { band, matrix: self, is_definite: &mut is_definite });
        is_definite
    }

    /// Solves with the factor, in place of the right-hand side.
    pub(crate) fn solve(&self, band: &Band, unknowns: &mut Vec<Complex<f64>>) {
        let count = unknowns.len();
        // The last columns are padded beyond the last row.
        unknowns.resize(count + GROUP, Complex::new(0.0, 0.0));
        dispatch(Solve { band, matrix: self, unknowns });
        unknowns.truncate(count);
    }
}

struct Factorise<'a, T> {
    band: &'a Band,
    matrix: &'a mut BandMatrix<T>,
    is_definite: &'a mut bool,
}

impl<T: Entry> Task for Factorise<'_, T> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, _: S) {
        let Self { band: Band { starts, lengths, .. }, matrix, is_definite } = self;
        let BandMatrix { values, inverses, column } = matrix;
        inverses.clear();
        for (step, &length) in lengths.iter().enumerate() {
            let (start, end) = (starts[step], starts[step + 1]);
            let (done, rest) = values.split_at_mut(end);
            let pivot = done[start].real();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return;
            }
            let inverse = 1.0 / pivot.sqrt();
            inverses.push(inverse);
            column.clear();
            for group in done[start + 1..].as_chunks_mut::<GROUP>().0 {
                *group = group.map(|value| value.scale(inverse));
                column.extend_from_slice(group);
            }
            // Whole groups can be taken from every row on.
            column.extend_from_slice(&[T::zero(); GROUP]);
            for below in 0..length {
                let factor = column[below].conjugate();
                let [first, last] = [0, 1].map(|k: usize| starts[step + 1 + below + k] - end);
                rest[first] -= column[below] * factor;
                let to = rest[first + 1..last].as_chunks_mut::<GROUP>().0;
                for (to, from) in to.iter_mut().zip(column[below + 1..].as_chunks::<GROUP>().0) {
                    for (to, &from) in to.iter_mut().zip(from) {
                        *to -= from * factor;
                    }
                }
            }
        }
        *is_definite = true;
    }
}

struct Solve<'a, T> {
    band: &'a Band,
    matrix: &'a BandMatrix<T>,
    unknowns: &'a mut [Complex<f64>],
}

impl<T: Entry> Task for Solve<'_, T> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, _: S) {
        let Self { band: Band { starts, .. }, matrix: BandMatrix { values, inverses, .. }, unknowns } = self;
        for (step, &inverse) in inverses.iter().enumerate() {
            let column = values[starts[step] + 1..starts[step + 1]].as_chunks::<GROUP>().0;
            let (done, rest) = unknowns.split_at_mut(step + 1);
            let value = inverse.times(done[step]);
            done[step] = value;
            for (to, factors) in rest.as_chunks_mut::<GROUP>().0.iter_mut().zip(column) {
                for (to, factor) in to.iter_mut().zip(factors) {
                    *to -= factor.times(value);
                }
            }
        }
        for (step, &inverse) in inverses.iter().enumerate().rev() {
            let column = values[starts[step] + 1..starts[step + 1]].as_chunks::<GROUP>().0;
            let (done, rest) = unknowns.split_at_mut(step + 1);
            // Several sums, so that one addition need not wait for the other.
            let mut sums = [Complex::new(0.0, 0.0); GROUP];
            for (from, factors) in rest.as_chunks::<GROUP>().0.iter().zip(column) {
                for ((sum, &from), factor) in sums.iter_mut().zip(from).zip(factors) {
                    *sum += factor.conjugate().times(from);
                }
            }
            done[step] = inverse.times(done[step] - ((sums[0] + sums[1]) + (sums[2] + sums[3])));
        }
    }
}
