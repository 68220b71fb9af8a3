//! Axis-aligned bounding boxes, one and eight side by side.
//!
//! The functions are always inlined, into callers that are compiled for each instruction set.

use crate::simd::{F32_LANES, F32x8Lanes, InstructionSet};

/// Children of a node and faces of a leaf: as many boxes as a vector has lanes.
pub(crate) const WIDTH: usize = F32_LANES;

/// More than the roundings of a coordinate of either box, relative to the nearer one: `8 u` of single precision. Two
/// that are rounded past each other differ by less than that.
pub(crate) const FAR_ROUNDING: f32 = 4.0 * f32::EPSILON;

/// An axis-aligned bounding box: its lowest and its highest corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aabb {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl Aabb {
    /// The box of a triangle.
    #[inline(always)]
    pub(crate) fn of_triangle<const N: usize>([a, b, c]: [&[f32; N]; 3]) -> Self {
        Self {
            min: std::array::from_fn(|axis| min(min(a[axis], b[axis]), c[axis])),
            max: std::array::from_fn(|axis| max(max(a[axis], b[axis]), c[axis])),
        }
    }

    /// The largest magnitude of a coordinate.
    #[inline(always)]
    pub(crate) fn max_abs(&self) -> f32 {
        self.min.into_iter().chain(self.max).fold(0.0, |largest, coordinate| max(largest, coordinate.abs()))
    }
}

/// Eight boxes, coordinate by coordinate. Unused slots hold the empty box, which overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct AabbX8 {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
}

impl AabbX8 {
    pub(crate) const EMPTY: Self = Self { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };

    #[inline(always)]
    pub(crate) fn get(&self, slot: usize) -> Aabb {
        // No `map`: it takes the rows by value, and their copies cost more than what is done with them.
        let corner = |rows: &[[f32; WIDTH]; 3]| [rows[0][slot], rows[1][slot], rows[2][slot]];
        Aabb { min: corner(&self.min), max: corner(&self.max) }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, slot: usize, aabb: Aabb) {
        for axis in 0..3 {
            self.min[axis][slot] = aabb.min[axis];
            self.max[axis][slot] = aabb.max[axis];
        }
    }

    /// The same boxes, larger by `margin` on every side.
    #[inline(always)]
    pub(crate) fn inflated(&self, margin: f32) -> Self {
        let mut boxes = *self;
        for axis in 0..3 {
            for slot in 0..WIDTH {
                boxes.min[axis][slot] -= margin;
                boxes.max[axis][slot] += margin;
            }
        }
        boxes
    }

    /// The same boxes, larger by `margin` and by what rounds far coordinates. Empty boxes stay empty.
    pub(crate) fn inflated_far(&self, margin: f32) -> Self {
        let mut boxes = *self;
        for axis in 0..3 {
            for slot in 0..WIDTH {
                let (low, high) = (boxes.min[axis][slot], boxes.max[axis][slot]);
                if low <= high {
                    boxes.min[axis][slot] = (low - (margin + FAR_ROUNDING * low.abs())).max(f32::MIN);
                    boxes.max[axis][slot] = (high + (margin + FAR_ROUNDING * high.abs())).min(f32::MAX);
                }
            }
        }
        boxes
    }

    /// The box around all of them.
    #[inline(always)]
    pub(crate) fn union(&self) -> Aabb {
        // By halves, a shape that vector instructions have.
        let least = |row: [f32; WIDTH]| {
            let half: [f32; 4] = std::array::from_fn(|lane| min(row[lane], row[lane + 4]));
            min(min(half[0], half[2]), min(half[1], half[3]))
        };
        let greatest = |row: [f32; WIDTH]| {
            let half: [f32; 4] = std::array::from_fn(|lane| max(row[lane], row[lane + 4]));
            max(max(half[0], half[2]), max(half[1], half[3]))
        };
        Aabb { min: self.min.map(least), max: self.max.map(greatest) }
    }

    /// One bit for each of the eight boxes that overlaps another one; touching counts.
    #[inline(always)]
    pub(crate) fn overlap_mask(&self, simd: impl InstructionSet, other: &Aabb) -> u32 {
        let simd = simd.f32x8();
        let mut mask = self.overlap_mask_along(simd, other, 0);
        for axis in 1..3 {
            mask = simd.and(mask, self.overlap_mask_along(simd, other, axis));
        }
        simd.mask_bits(mask)
    }

    /// The boxes whose intervals along an axis overlap that of another one.
    #[inline(always)]
    fn overlap_mask_along<L: F32x8Lanes>(&self, simd: L, other: &Aabb, axis: usize) -> L::Mask {
        let begins = simd.le(simd.load(&self.min[axis]), simd.splat_f32(other.max[axis]));
        let ends = simd.le(simd.splat_f32(other.min[axis]), simd.load(&self.max[axis]));
        simd.and(begins, ends)
    }

    /// Bit `8 i + k` for each pair of box `i` of these and box `k` of `others` that overlap.
    ///
    /// All 64 are compared without a branch: which of them overlap is hard to predict, and a branch that is predicted
    /// wrongly costs more than a few comparisons.
    #[inline(always)]
    pub(crate) fn overlap_mask_x8(&self, simd: impl InstructionSet, others: &Self) -> u64 {
        let mut pairs = 0;
        for slot in 0..WIDTH {
            pairs |= u64::from(others.overlap_mask(simd, &self.get(slot))) << (WIDTH * slot);
        }
        pairs
    }
}

/// The smaller of two numbers, neither of which is NaN: one instruction, where `f32::min` takes several.
#[inline(always)]
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Portable, Task, dispatch};

    #[test]
    fn overlap_mask_of_touching_boxes_is_the_same_for_every_instruction_set() {
        struct Compare(AabbX8, Aabb, u32);
        impl Task for Compare {
            fn run<S: InstructionSet>(self, simd: S) {
                assert_eq!(self.0.overlap_mask(simd, &self.1), self.2);
            }
        }
        let mut state = 5u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            #[allow(clippy::cast_precision_loss, reason = "small numbers, so that boxes touch exactly")]
            let number = (state >> 61) as f32;
            number
        };
        let mut seen = [0; 2];
        for _ in 0..1_000 {
            let mut boxes = AabbX8::EMPTY;
            let mut expected = 0;
            let mut aabb = || {
                let min = [next(), next(), next()];
                Aabb { min, max: min.map(|x| x + next()) }
            };
            let other = aabb();
            for slot in 0..7 {
                let one = aabb();
                boxes.set(slot, one);
                let touches = (0..3).all(|axis| one.min[axis] <= other.max[axis] && one.max[axis] >= other.min[axis]);
                expected |= u32::from(touches) << slot;
                seen[usize::from(touches)] += 1;
            }
            assert_eq!(boxes.overlap_mask(Portable, &other), expected);
            dispatch(Compare(boxes, other, expected));
        }
        assert!(seen[0] > 1_000 && seen[1] > 1_000);
    }
}
