//! States of generated sheets.

use untangled_testkit::generate::Sheet;

/// Positions of a sheet that is hardly bent, in metres.
#[must_use]
pub fn bent(sheet: &Sheet) -> Vec<[f64; 3]> {
    sheet.uvs.iter().map(|&[u, v]| [u, v, 0.1 * (3.0 * u).sin() * v]).collect()
}

/// Positions `number` frames later: the sheet of `resolution x resolution` squares has moved on by five edges a frame,
/// and waves of a hundredth of an edge run through it.
#[must_use]
pub fn later(sheet: &Sheet, positions: &[[f64; 3]], resolution: u32, number: u32) -> Vec<[f64; 3]> {
    let (edge, time) = (1.0 / f64::from(resolution), f64::from(number));
    let moved = |(&[x, y, z], &[u, _]): (&[f64; 3], &[f64; 2])| {
        [x, y + 5.0 * edge * time, z + 0.01 * edge * (0.3 * time + 7.0 * u).sin()]
    };
    positions.iter().zip(&sheet.uvs).map(moved).collect()
}
