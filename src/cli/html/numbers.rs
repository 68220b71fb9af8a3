//! Arrays of numbers as a page holds them.

use base64::{Engine, engine::general_purpose::STANDARD};

/// Numbers in single precision, little-endian, as base64: half the bytes that decimals take, and read at once.
pub(super) fn singles(values: impl IntoIterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(|value| single(value).to_le_bytes()).collect();
    STANDARD.encode(bytes)
}

/// A number in single precision.
pub(super) fn single(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "a picture needs no more than single precision")]
    let rounded = value as f32;
    rounded
}

/// Whole numbers of four bytes, little-endian, as base64.
pub(super) fn whole(values: impl IntoIterator<Item = u32>) -> String {
    let bytes: Vec<u8> = values.into_iter().flat_map(u32::to_le_bytes).collect();
    STANDARD.encode(bytes)
}

/// A count or an index; meshes have less than 2^32 of everything.
pub(super) fn index(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}
