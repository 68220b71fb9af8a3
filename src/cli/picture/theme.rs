//! Colours.

use nalgebra::Vector3;

use untangle::paths::PairType;

/// Red, green and blue from 0 to 1. Lighting and blending take them for linear, which is good enough for cloth.
pub(super) type Colour = Vector3<f32>;

/// Colour of text.
pub(super) const INK: Colour = Colour::new(0.16, 0.18, 0.22);

/// Colour of a piece of cloth: four calm colours in turn.
pub(super) fn cloth(piece: usize) -> Colour {
    const CLOTHS: [[f32; 3]; 4] = [[0.93, 0.90, 0.84], [0.66, 0.76, 0.86], [0.80, 0.84, 0.76], [0.90, 0.80, 0.76]];
    Colour::from(CLOTHS[piece % CLOTHS.len()])
}

/// Colour of the background in a row of the picture or of its samples.
pub(super) fn background(row: usize, height: usize) -> Colour {
    #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand rows")]
    let part = row as f32 / height.max(1) as f32;
    Colour::new(0.97, 0.97, 0.98).lerp(&Colour::new(0.84, 0.86, 0.89), part)
}

/// Colour of a type of path. Types that often occur together are far apart in colour.
pub(super) fn path(pair_type: PairType) -> Colour {
    let [r, g, b] = match pair_type {
        PairType::Closed => [0xd7, 0x26, 0x3d],
        PairType::Eight => [0x8e, 0x3b, 0xc4],
        PairType::LoopLoop => [0x1b, 0x99, 0x4f],
        PairType::BoundaryLoopInside => [0xe6, 0x3f, 0xa8],
        PairType::BoundaryLoopBoundary => [0x9c, 0x4f, 0x2e],
        PairType::BoundaryLoopLoopBoundary => [0x6b, 0x6e, 0x1a],
        PairType::Cross => [0x0f, 0x9a, 0xa6],
        PairType::BoundaryBoundaryInsideInside => [0x1f, 0x5f, 0xd0],
        PairType::BoundaryBoundaryBoundaryInside => [0x4c, 0x3a, 0xa0],
        PairType::BoundaryBoundaryBoundaryBoundary => [0x2c, 0x2c, 0x6e],
        PairType::BoundaryInside => [0xf0, 0x8a, 0x0c],
    }
    .map(|byte: u8| f32::from(byte) / 255.0);
    Colour::new(r, g, b)
}

/// The bytes of a colour in a file.
pub(super) fn to_bytes(colour: Colour) -> [u8; 3] {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=255")]
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    [byte(colour.x), byte(colour.y), byte(colour.z)]
}

/// The nearest single: precise enough for colours and for nearness.
#[expect(clippy::cast_possible_truncation, reason = "colours and nearness need no more than single precision")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}
