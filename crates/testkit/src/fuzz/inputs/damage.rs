//! Damage to valid bytes.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Changes some bytes, or cuts, repeats or moves some.
pub(in crate::fuzz) fn damage(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>) {
    for _ in 0..rng.random_range(1..5) {
        if bytes.is_empty() {
            return;
        }
        let at = rng.random_range(0..bytes.len());
        let end = (at + rng.random_range(1..32)).min(bytes.len());
        match rng.random_range(0..7) {
            0 => bytes[at] = rng.random(),
            1 => bytes[at] ^= 1 << rng.random_range(0..8),
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                let to = rng.random_range(0..=bytes.len());
                bytes.splice(to..to, piece);
            }
            5 => bytes[at..end].fill([0, 255, b'9', b'-', b' ', b'\n'][rng.random_range(0..6)]),
            _ => {
                let value = [0u64, 1, u64::MAX, 1 << 31, 1 << 32, 1 << 63][rng.random_range(0..6)].to_le_bytes();
                for (byte, value) in bytes[at..].iter_mut().zip(value) {
                    *byte = value;
                }
            }
        }
    }
}
