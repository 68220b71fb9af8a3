//! Forward and back substitution with a dense factor, for two right-hand sides at once.

use super::rows::{Row, add_scaled, dot};
use crate::simd::{F64_LANES, F64Lanes, InstructionSet, Task, dispatch};

/// Solves `L L^T x = b` in the leading `rank` rows and columns of a factor that is given column by column in whole rows
/// of lanes, of which the lower half is used. The right-hand sides, zero behind the leading rows, become the solutions.
pub(super) fn solve_leading(factor: &[Row], rank: usize, unknowns: &mut [Vec<Row>; 2]) {
    dispatch(Solve { factor, rank, unknowns });
}

struct Solve<'a> {
    factor: &'a [Row],
    rank: usize,
    unknowns: &'a mut [Vec<Row>; 2],
}

impl Task for Solve<'_> {
    #[inline(always)]
    fn run<S: InstructionSet>(self, simd: S) {
        let simd = simd.f64();
        let Self { factor, rank, unknowns } = self;
        let blocks = unknowns[0].len().max(1);
        for (step, column) in factor.chunks_exact(blocks).enumerate().take(rank) {
            for values in &mut *unknowns {
                forwards(simd, column, step, values);
            }
        }
        for values in &mut *unknowns {
            values.as_flattened_mut()[rank..].fill(0.0);
        }
        for (step, column) in factor.chunks_exact(blocks).enumerate().take(rank).rev() {
            for values in &mut *unknowns {
                backwards(simd, column, step, values);
            }
        }
    }
}

/// Divides an unknown by its pivot, and subtracts what it adds to those below it.
#[inline(always)]
fn forwards<L: F64Lanes>(simd: L, column: &[Row], step: usize, values: &mut [Row]) {
    let (block, lane) = (step / F64_LANES, step % F64_LANES);
    let value = values[block][lane] / column[block][lane];
    values[block][lane] = value;
    for lane in lane + 1..F64_LANES {
        values[block][lane] -= value * column[block][lane];
    }
    add_scaled(simd, &mut values[block + 1..], -value, &column[block + 1..]);
}

/// Subtracts from an unknown what those below it add to it, and divides it by its pivot.
#[inline(always)]
fn backwards<L: F64Lanes>(simd: L, column: &[Row], step: usize, values: &mut [Row]) {
    let (block, lane) = (step / F64_LANES, step % F64_LANES);
    let mut rest = values[block][lane] - dot(simd, &column[block + 1..], &values[block + 1..]);
    for lane in lane + 1..F64_LANES {
        rest -= column[block][lane] * values[block][lane];
    }
    values[block][lane] = rest / column[block][lane];
}
