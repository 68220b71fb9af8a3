//! Files with random damage.

use super::{ASCII_PLY, ODD_OBJ, binary_ply};
use crate::formats::{obj, ply};

#[test]
fn parse_of_damaged_files_never_panics() {
    let seeds = [ODD_OBJ.to_vec(), ASCII_PLY.as_bytes().to_vec(), binary_ply(true, "double")];
    let mut state = 7u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below
    };
    let (mut good, mut bad) = (0, 0);
    for round in 0..3_000 {
        let mut bytes = seeds[round % 3].clone();
        for _ in 0..=next(4) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = u8::try_from(next(256)).unwrap(),
                1 => bytes.truncate(at + 1),
                _ => bytes.insert(at, b"0-9/\\\n #e"[next(9)]),
            }
        }
        let parsed = if round % 3 == 0 { obj::parse(bytes).map(drop) } else { ply::parse(bytes).map(drop) };
        if parsed.is_ok() { good += 1 } else { bad += 1 }
    }
    assert!(good > 100 && bad > 100, "{good} {bad}");
}
