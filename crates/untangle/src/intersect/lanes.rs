//! Choice of instruction set: the same answers, faster where the processor allows it.

use super::{
    arithmetic::Plain,
    boxes::{Boxes, Hull, WIDTH},
    separate::{FourTriangles, Triangle, are_apart, are_four_apart, distances_m},
    singles::{Eights, Singles},
};

/// Pairs of triangles that are looked at side by side.
pub(crate) const FOUR: usize = 4;

/// What goes through boxes eight at a time.
pub(crate) trait Lanes: Copy {
    type Eight: Eights;

    /// Arithmetic with eight numbers at once.
    fn eight(self) -> Self::Eight;

    /// A bit for each of eight boxes that overlaps another one; touching counts.
    fn overlaps(self, boxes: &Boxes, hull: &Hull) -> u32;

    /// Bit `8 i + k` for each pair of boxes `i` of one node and `k` of another that overlap. All at once: which do is hard to foretell, and a
    /// wrong guess costs more than a few comparisons.
    #[inline(always)]
    fn overlapping_pairs(self, first: &Boxes, second: &Boxes) -> u64 {
        let mut pairs = 0;
        for slot in 0..WIDTH {
            pairs |= u64::from(self.overlaps(second, &first.get(slot))) << (WIDTH * slot);
        }
        pairs
    }

    /// A bit for each of four pairs of triangles that is proven to be apart, and those in `unused`.
    fn apart(self, pairs: &[FourTriangles; 2], unused: u32) -> u32;

    /// Lower bounds of the distances of four pairs of triangles in metres, as far as `enough`; those in `unused` are of no interest.
    fn distances_m(self, pairs: &[FourTriangles; 2], enough: f64, unused: u32) -> [f64; FOUR];
}

/// Work to be compiled for each instruction set. Its functions have to be inlined all the way down, or they are compiled for the least
/// one.
pub(crate) trait Task {
    fn run<L: Lanes>(self, lanes: L);
}

/// Any processor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Lanes for Portable {
    type Eight = Singles<Self>;

    #[inline(always)]
    fn eight(self) -> Self::Eight {
        Singles(self)
    }

    #[inline(always)]
    fn overlaps(self, boxes: &Boxes, (low, high): &Hull) -> u32 {
        let mut hits = [true; WIDTH];
        for axis in 0..3 {
            let (low, high) = (low[axis], high[axis]);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit &= (boxes.min[axis][lane] <= high) & (boxes.max[axis][lane] >= low);
            }
        }
        hits.iter().enumerate().fold(0, |mask, (lane, &hit)| mask | (u32::from(hit) << lane))
    }

    #[inline(always)]
    fn apart(self, pairs: &[FourTriangles; 2], unused: u32) -> u32 {
        (0..FOUR).filter(|lane| unused >> lane & 1 == 0).fold(unused, |mask, lane| {
            mask | (u32::from(are_apart(&one_of(&pairs[0], lane), &one_of(&pairs[1], lane))) << lane)
        })
    }

    #[inline(always)]
    fn distances_m(self, pairs: &[FourTriangles; 2], enough: f64, unused: u32) -> [f64; FOUR] {
        std::array::from_fn(|lane| {
            let pair = [&one_of(&pairs[0], lane), &one_of(&pairs[1], lane)];
            if unused >> lane & 1 == 0 { distances_m(Plain, pair, enough, 0) } else { 0.0 }
        })
    }
}

/// One of four triangles.
fn one_of(four: &FourTriangles, lane: usize) -> Triangle {
    four.map(|corner| corner.map(|coordinate| coordinate[lane]))
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V3 {
    type Eight = Singles<Self>;

    #[inline(always)]
    fn eight(self) -> Self::Eight {
        Singles(self)
    }

    #[inline(always)]
    fn overlaps(self, boxes: &Boxes, (low, high): &Hull) -> u32 {
        let mut apart = self.splat_u32x8(0);
        for axis in 0..3 {
            let (min, max) = (pulp::cast(boxes.min[axis]), pulp::cast(boxes.max[axis]));
            let above = self.cmp_gt_f32x8(min, self.splat_f32x8(high[axis]));
            let below = self.cmp_lt_f32x8(max, self.splat_f32x8(low[axis]));
            apart = self.or_u32x8(apart, self.or_u32x8(pulp::cast(above), pulp::cast(below)));
        }
        !self.avx._mm256_movemask_ps(pulp::cast(apart)).cast_unsigned() & 0xff
    }

    #[inline(always)]
    fn apart(self, pairs: &[FourTriangles; 2], unused: u32) -> u32 {
        let [a, b] = vectors(self, pairs);
        are_four_apart(self, [&a, &b], unused)
    }

    #[inline(always)]
    fn distances_m(self, pairs: &[FourTriangles; 2], enough: f64, unused: u32) -> [f64; FOUR] {
        let [a, b] = vectors(self, pairs);
        pulp::cast(distances_m(self, [&a, &b], enough, unused))
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn vectors(simd: pulp::x86::V3, pairs: &[FourTriangles; 2]) -> [Triangle<pulp::f64x4>; 2] {
    let mut vectors = [[[simd.splat_f64x4(0.0); 3]; 3]; 2];
    for (vectors, four) in vectors.iter_mut().zip(pairs) {
        for corner in 0..3 {
            for axis in 0..3 {
                vectors[corner][axis] = pulp::cast(four[corner][axis]);
            }
        }
    }
    vectors
}

/// Runs a task with the best instructions that this processor has.
pub(crate) fn dispatch(task: impl Task) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return simd.vectorize(With(task, simd));
    }
    task.run(Portable);
}

#[cfg(target_arch = "x86_64")]
struct With<T, L>(T, L);

#[cfg(target_arch = "x86_64")]
impl<T: Task, L: Lanes> pulp::NullaryFnOnce for With<T, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run(self.1);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::intersect::boxes::EMPTY;

    #[test]
    fn all_instruction_sets_give_the_same_bits() {
        struct Compare(Boxes, Hull, u32);
        impl Task for Compare {
            fn run<L: Lanes>(self, lanes: L) {
                assert_eq!(lanes.overlaps(&self.0, &self.1), self.2);
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
            let mut boxes = EMPTY;
            let mut expected = 0;
            let mut hull = || {
                let low = [next(), next(), next()];
                (low, low.map(|x| x + next()))
            };
            let other = hull();
            for slot in 0..7 {
                let (low, high) = hull();
                boxes.set(slot, (low, high));
                let touches = (0..3).all(|axis| low[axis] <= other.1[axis] && high[axis] >= other.0[axis]);
                expected |= u32::from(touches) << slot;
                seen[usize::from(touches)] += 1;
            }
            assert_eq!(Portable.overlaps(&boxes, &other), expected);
            dispatch(Compare(boxes, other, expected));
        }
        assert!(seen[0] > 1_000 && seen[1] > 1_000);
    }

    #[test]
    fn four_pairs_at_a_time_are_as_far_apart_as_one_by_one() {
        struct Compare<'a>([FourTriangles; 2], f64, u32, &'a mut [usize; 2]);
        impl Task for Compare<'_> {
            fn run<L: Lanes>(self, lanes: L) {
                let Self(pairs, enough, unused, seen) = self;
                let apart = lanes.apart(&pairs, unused);
                let distances = lanes.distances_m(&pairs, enough, unused);
                assert_eq!(apart, Portable.apart(&pairs, unused));
                for (lane, (one, other)) in
                    distances.into_iter().zip(Portable.distances_m(&pairs, enough, 0)).enumerate()
                {
                    if unused >> lane & 1 == 0 {
                        // Beyond what is enough any number will do.
                        assert_eq!(one.min(enough).to_bits(), other.min(enough).to_bits());
                        seen[usize::from(one > 0.0)] += 1;
                    }
                }
            }
        }
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut seen = [0; 2];
        for round in 0..2_000 {
            let mut triangles = <[FourTriangles; 2]>::default();
            for coordinate in triangles.iter_mut().flatten().flatten().flatten() {
                // Now and then on a coarse grid, where triangles touch and are degenerate.
                *coordinate =
                    if round % 2 == 0 { rng.random_range(-1.0..1.0) } else { f64::from(rng.random_range(0..3)) };
            }
            dispatch(Compare(triangles, 0.3, round % 16, &mut seen));
        }
        assert!(seen[0] > 500 && seen[1] > 500, "{seen:?}");
    }
}
