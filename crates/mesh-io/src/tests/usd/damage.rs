//! Layers with random damage: refused or read, without a panic and without memory that they have not paid for.

use std::{fs, path::Path};

use super::QUADS;
use crate::VertexCache;

/// Whether a stage is read with all of its frames.
fn is_read(path: &Path) -> bool {
    let cache = VertexCache::open_usd(path, "/world");
    cache.is_ok_and(|(_, cache)| cache.frames().all(|frame| cache.read(frame).is_ok()))
}

#[test]
fn damaged_stages_are_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = 7u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below
    };
    for (name, whole) in QUADS {
        let path = folder.path().join(name);
        let (mut good, mut bad) = (0, 0);
        for _ in 0..2_000 {
            let mut bytes = whole.to_vec();
            for _ in 0..=next(3) {
                let at = next(bytes.len());
                match next(4) {
                    0 => bytes.truncate(at + 1),
                    1 => drop(bytes.splice(at..at, [b'0', b'[', b'{', b'"', 0xff][next(5)..].iter().copied())),
                    _ => bytes[at] = u8::try_from(next(256)).unwrap(),
                }
            }
            fs::write(&path, bytes).unwrap();
            if is_read(&path) { good += 1 } else { bad += 1 }
        }
        assert!(good > 20 && bad > 100, "{name} {good} {bad}");
    }
}

#[test]
fn lengths_of_a_crate_file_that_lie_cost_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let (name, whole) = QUADS[1];
    let path = folder.path().join(name);
    let mut num_read = 0;
    for at in 0..whole.len() - 8 {
        for value in [u64::MAX, 1 << 62, 1 << 40, 1 << 31] {
            let mut bytes = whole.to_vec();
            bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            fs::write(&path, bytes).unwrap();
            num_read += usize::from(is_read(&path));
        }
    }
    assert!(num_read > 0);
}
