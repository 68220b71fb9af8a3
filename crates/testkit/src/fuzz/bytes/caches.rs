//! Vertex caches, over a mesh of four vertices.

use untangled_mesh_io::{VertexCache, read_mesh};

use super::scratch;
use crate::fuzz::checks::check_refusal;

pub(super) const NUM_VERTICES: usize = 4;
const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

pub(super) fn pc2(bytes: &[u8]) -> bool {
    cache("cache.pc2", bytes)
}

pub(super) fn mdd(bytes: &[u8]) -> bool {
    cache("cache.mdd", bytes)
}

/// Header and frames, written one after the other, are the file; what is stored of moved frames is read back.
fn cache(name: &str, bytes: &[u8]) -> bool {
    let mesh = read_mesh(scratch::write("quad.obj", QUAD.as_bytes())).expect("it is a mesh");
    let path = scratch::write(name, bytes);
    let cache = match VertexCache::open(&path, &[mesh]) {
        Ok(cache) => cache,
        Err(error) => {
            check_refusal(&error.to_string(), &path);
            return false;
        }
    };
    let mut written = cache.header(&cache.frames());
    for number in cache.frames() {
        let frame = match cache.read(number) {
            Ok(frame) => frame,
            Err(error) => {
                let words = error.to_string();
                check_refusal(&words, &path);
                assert!(words.contains(&format!("frame {number}")), "the refusal names the frame: {words}");
                return false;
            }
        };
        assert_eq!(frame.positions().len(), NUM_VERTICES);
        assert!(frame.positions().as_flattened().iter().all(|x| x.is_finite()), "positions are finite");
        written.extend(frame.encode(frame.positions()).expect("a frame is written as it was read"));
        let moved: Vec<[f64; 3]> = frame.positions().iter().map(|place| place.map(|x| 0.75 * x + 0.1)).collect();
        let stored = frame.stored_positions(&moved).expect("it is nearer to zero than what was read, or small");
        let own = frame.encode(&moved).expect("what is stored is written");
        let back = cache.decode(number, own).expect("what was written is read");
        let bits = |positions: &[[f64; 3]]| positions.iter().map(|p| p.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(back.positions()), bits(&stored), "a frame is read as it was stored");
    }
    assert!(bytes == written, "a cache is written back as it was");
    true
}
