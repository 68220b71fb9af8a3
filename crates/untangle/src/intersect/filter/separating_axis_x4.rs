//! The separating-axis test for four pairs of triangles in double precision: whether they are apart, and by how much.

use super::separating_axis::{AxisTest, Separated, Triangle, TrianglePair};
use crate::simd::{F64_LANES, F64Lanes, InstructionSet, Lanes};

/// Four triangles, coordinate by coordinate.
pub(crate) type TrianglesX4 = Triangle<[f64; F64_LANES]>;

/// The mask of all four pairs.
pub(crate) const ALL_X4: u32 = (1 << F64_LANES) - 1;

/// Puts a pair of triangles into a lane.
#[inline(always)]
pub(crate) fn set_pair(pairs: &mut [TrianglesX4; 2], lane: usize, pair: [Triangle; 2]) {
    for (four, triangle) in pairs.iter_mut().zip(pair) {
        for (four, corner) in four.iter_mut().zip(triangle) {
            for (lanes, coordinate) in four.iter_mut().zip(corner) {
                lanes[lane] = coordinate;
            }
        }
    }
}

/// One bit for each of four pairs of triangles for which a separating axis is found, or that is marked in `unused`.
#[inline(always)]
pub(crate) fn separated_mask_x4<S: InstructionSet>(simd: S, pairs: &[TrianglesX4; 2], unused: u32) -> u32 {
    let simd = simd.f64();
    let all = vector_mask::<S::F64>();
    let mut mask = unused;
    for first in (0..F64_LANES).step_by(S::F64::WIDTH) {
        let mut separated = Separated { mask: unused >> first & all, all };
        if separated.mask != all {
            load_pair(simd, pairs, first).try_all_axes(&mut separated);
            mask |= separated.mask << first;
        }
    }
    mask
}

/// Lower bounds of the distances of four pairs of triangles in metres, zero where none is known.
///
/// A pair that is found to be further apart than `enough` is not measured any better; pairs marked in `unused` get any
/// number.
#[inline(always)]
pub(crate) fn max_gaps_m_x4<S: InstructionSet>(
    simd: S,
    pairs: &[TrianglesX4; 2],
    enough: f64,
    unused: u32,
) -> [f64; F64_LANES] {
    let simd = simd.f64();
    let all = vector_mask::<S::F64>();
    let mut gaps_m = [0.0; F64_LANES];
    for first in (0..F64_LANES).step_by(S::F64::WIDTH) {
        let unused = unused >> first & all;
        if unused != all {
            let mut max_gap = MaxGap { gap_m: simd.splat(0.0), enough: simd.splat(enough), unused };
            load_pair(simd, pairs, first).try_all_axes(&mut max_gap);
            simd.store(max_gap.gap_m, &mut gaps_m, first);
        }
    }
    gaps_m
}

/// One bit for each lane of a vector.
#[inline(always)]
fn vector_mask<L: F64Lanes>() -> u32 {
    (1 << L::WIDTH) - 1
}

/// As many pairs as a vector has lanes.
#[inline(always)]
fn load_pair<L: F64Lanes>(simd: L, pairs: &[TrianglesX4; 2], first: usize) -> TrianglePair<L> {
    let mut vectors = [[[simd.splat(0.0); 3]; 3]; 2];
    for (vectors, four) in vectors.iter_mut().zip(pairs) {
        for corner in 0..3 {
            for axis in 0..3 {
                vectors[corner][axis] = simd.load(&four[corner][axis], first);
            }
        }
    }
    TrianglePair::new(simd, &vectors[0], &vectors[1])
}

/// The largest gap along any axis, in metres: the triangles are at least that far apart.
struct MaxGap<V> {
    gap_m: V,
    enough: V,
    unused: u32,
}

impl<L: F64Lanes> AxisTest<L> for MaxGap<L::Vector> {
    #[inline(always)]
    fn try_axis(&mut self, pair: &TrianglePair<L>, axis: [L::Vector; 3]) -> bool {
        let simd = pair.simd;
        let (gap, square) = (pair.gap_along(axis), simd.dot(axis, axis));
        let gap_m = simd.mul(simd.div(gap, simd.sqrt(square)), simd.splat(1.0 - 1e-14));
        // A square that underflows says nothing about the length.
        let zero = simd.splat(0.0);
        let gap_m = simd.select(gap, simd.select(simd.sub(square, simd.splat(1e-280)), gap_m, zero), zero);
        self.gap_m = simd.max(self.gap_m, gap_m);
        simd.gt_zero_mask(simd.sub(self.enough, self.gap_m)) & !self.unused == 0
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::simd::{Portable, Task, dispatch};

    struct Compare<'a>([TrianglesX4; 2], f64, u32, &'a mut [usize; 2]);

    impl Task for Compare<'_> {
        fn run<S: InstructionSet>(self, simd: S) {
            let Self(pairs, enough, unused, seen) = self;
            let mask = separated_mask_x4(simd, &pairs, unused);
            let gaps_m = max_gaps_m_x4(simd, &pairs, enough, unused);
            assert_eq!(mask, separated_mask_x4(Portable, &pairs, unused));
            for (lane, (one, other)) in gaps_m.into_iter().zip(max_gaps_m_x4(Portable, &pairs, enough, 0)).enumerate() {
                if unused >> lane & 1 == 0 {
                    // Beyond what is enough any number is right.
                    assert_eq!(one.min(enough).to_bits(), other.min(enough).to_bits());
                    seen[usize::from(one > 0.0)] += 1;
                }
            }
        }
    }

    #[test]
    fn gaps_of_four_pairs_are_those_of_single_pairs() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut seen = [0; 2];
        for round in 0..2_000 {
            let mut triangles = <[TrianglesX4; 2]>::default();
            for coordinate in triangles.iter_mut().flatten().flatten().flatten() {
                // Every other round on a coarse grid, where triangles touch and are degenerate.
                *coordinate =
                    if round % 2 == 0 { rng.random_range(-1.0..1.0) } else { f64::from(rng.random_range(0..3)) };
            }
            dispatch(Compare(triangles, 0.3, round % 16, &mut seen));
        }
        assert!(seen[0] > 500 && seen[1] > 500, "{seen:?}");
    }
}
