//! All instruction sets against scalar arithmetic.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{F32_LANES, F32x8Lanes, F64_LANES, F64Lanes, InstructionSet, Portable, Task, dispatch};

/// The bits of all operations on rows of double precision.
fn f64_bits<L: F64Lanes>(simd: L, [a, b]: [&[f64; F64_LANES]; 2]) -> Vec<u64> {
    let mut bits = Vec::new();
    for operation in 0..11 {
        let mut row = [0.0; F64_LANES];
        for first in (0..F64_LANES).step_by(L::WIDTH) {
            let (x, y) = (simd.load(a, first), simd.load(b, first));
            let result = match operation {
                0 => simd.add(x, y),
                1 => simd.sub(x, y),
                2 => simd.mul(x, y),
                3 => simd.div(x, y),
                4 => simd.sqrt(simd.abs(x)),
                5 => simd.min(x, y),
                6 => simd.max(x, y),
                7 => simd.select(x, y, simd.splat(0.1)),
                8 | 9 => simd.split(simd.abs(x))[operation - 8],
                _ => simd.cross([x, y, x], [y, x, y])[0],
            };
            simd.store(result, &mut row, first);
        }
        bits.extend(row.map(f64::to_bits));
    }
    let masks = (0..F64_LANES).step_by(L::WIDTH).map(|first| simd.gt_zero_mask(simd.load(a, first)) << first);
    bits.push(u64::from(masks.sum::<u32>()));
    bits
}

/// The masks of all operations on eight lanes of single precision: their results are compared with each other.
fn f32_masks<L: F32x8Lanes>(simd: L, rows: &[[f32; 4]], indices: &[u32; F32_LANES]) -> Vec<u32> {
    let [x, y, z] = simd.gather(rows, indices);
    let results = [
        simd.add(x, y),
        simd.sub(x, y),
        simd.mul(x, simd.load(&[0.7; F32_LANES])),
        simd.abs(z),
        simd.min(x, y),
        simd.max(x, y),
        simd.select(x, y, z),
        simd.splat(0.1),
        simd.splat_f32(-0.2),
        simd.dot([x, y, z], [y, z, x]),
    ];
    let mut masks = Vec::new();
    for a in results {
        masks.push(simd.gt_zero_mask(a));
        masks.extend(results.map(|b| simd.mask_bits(simd.and(simd.le(a, b), simd.le(simd.mul(b, b), a)))));
    }
    masks
}

struct Compare<'a> {
    doubles: [[f64; F64_LANES]; 2],
    rows: &'a [[f32; 4]],
    indices: [u32; F32_LANES],
}

impl Task for Compare<'_> {
    fn run<S: InstructionSet>(self, simd: S) {
        let Self { doubles: [a, b], rows, indices } = self;
        assert_eq!(f64_bits(simd.f64(), [&a, &b]), f64_bits(Portable.f64(), [&a, &b]));
        assert_eq!(f32_masks(simd.f32x8(), rows, &indices), f32_masks(Portable.f32x8(), rows, &indices));
    }
}

#[test]
fn lanes_of_every_instruction_set_give_the_bits_of_scalars() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let rows: Vec<[f32; 4]> = (0..50).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
    for _ in 0..500 {
        let doubles = std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let indices = std::array::from_fn(|_| rng.random_range(0..50));
        dispatch(Compare { doubles, rows: &rows, indices });
    }
}
