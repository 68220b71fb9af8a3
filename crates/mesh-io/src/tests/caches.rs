//! Vertex caches: what is read, what is written back, and what is refused.

use std::{fs, path::Path};

use crate::{MeshFile, VertexCache, read_mesh};

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

fn mesh(folder: &Path) -> MeshFile {
    fs::write(folder.join("quad.obj"), QUAD).unwrap();
    read_mesh(folder.join("quad.obj")).unwrap()
}

/// The coordinate of a frame: no two are the same.
fn value(frame: u32, at: u32) -> f32 {
    0.1 * f32::from(u16::try_from(100 * frame + at).unwrap())
}

fn pc2(num_frames: u32) -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0".to_vec();
    bytes.extend([1u32, 4].iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend([10.0f32, 0.5].iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend(num_frames.to_le_bytes());
    bytes.extend((0..num_frames).flat_map(|frame| (0..12).flat_map(move |at| value(frame, at).to_le_bytes())));
    bytes
}

fn mdd(num_frames: u32) -> Vec<u8> {
    let mut bytes: Vec<u8> = [num_frames, 4].iter().flat_map(|word| word.to_be_bytes()).collect();
    bytes.extend((0..num_frames).flat_map(|frame| (value(frame, 0) / 24.0).to_be_bytes()));
    bytes.extend((0..num_frames).flat_map(|frame| (0..12).flat_map(move |at| value(frame, at).to_be_bytes())));
    bytes
}

/// The error of a file in one line.
fn error(folder: &Path, name: &str, bytes: &[u8]) -> String {
    fs::write(folder.join(name), bytes).unwrap();
    let cache = VertexCache::open(&folder.join(name), &[mesh(folder)]);
    let error = cache.and_then(|cache| cache.frames().try_for_each(|frame| cache.read(frame).map(|_| ()))).unwrap_err();
    error.to_string().replace(&format!("{}/", folder.display()), "")
}

#[test]
fn pc2_and_mdd_are_written_back_bit_for_bit_but_for_what_moved() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, header_size) in [("a.pc2", pc2(3), 32), ("a.MDD", mdd(3), 8 + 12)] {
        fs::write(folder.path().join(name), &bytes).unwrap();
        let cache = VertexCache::open(&folder.path().join(name), &[mesh(folder.path())]).unwrap();
        assert_eq!(cache.frames(), 0..=2);
        let mut written = cache.header(&cache.frames());
        assert_eq!(written, bytes[..header_size]);
        for frame in cache.frames().map(|frame| cache.read(frame).unwrap()) {
            assert!(frame.is_single_precision());
            written.extend(frame.encode(frame.positions()).unwrap());
        }
        assert_eq!(written, bytes);
        let frame = cache.read(1).unwrap();
        let expected = [9, 10, 11].map(|at| f64::from(value(1, at)).to_bits());
        assert_eq!(frame.positions()[3].map(f64::to_bits), expected);
        let mut moved = frame.positions().to_vec();
        moved[3][1] = 0.1;
        let own = frame.encode(&moved).unwrap();
        let stored = frame.stored_positions(&moved).unwrap();
        assert_eq!(stored[3][1].to_bits(), f64::from(0.1f32).to_bits());
        assert_eq!(cache.decode(1, own.clone()).unwrap().positions(), stored);
        let start = header_size + 48;
        assert_eq!(own[..40], bytes[start..start + 40]);
        assert_eq!(own[44..], bytes[start + 44..start + 48]);
        assert_ne!(own[40..44], bytes[start + 40..start + 44]);
        moved[0][0] = 1e39;
        assert!(frame.encode(&moved).unwrap_err().to_string().contains("beyond single precision"));
    }
}

#[test]
fn headers_of_parts_keep_the_times_of_their_frames() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.pc2"), pc2(5)).unwrap();
    fs::write(folder.path().join("a.mdd"), mdd(5)).unwrap();
    let open = |name: &str| VertexCache::open(&folder.path().join(name), &[mesh(folder.path())]).unwrap();
    let header = open("a.pc2").header(&(2..=3));
    assert_eq!(header[..20], pc2(5)[..20]);
    assert_eq!(header[20..], [&11.0f32.to_le_bytes()[..], &0.5f32.to_le_bytes(), &2u32.to_le_bytes()].concat());
    let (header, whole) = (open("a.mdd").header(&(2..=3)), mdd(5));
    assert_eq!(header, [&2u32.to_be_bytes(), &whole[4..8], &whole[16..24]].concat());
}

#[test]
fn numbered_meshes_keep_their_bytes_and_their_padding() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for frame in 98..=101 {
        fs::write(path.join(format!("q.{frame:03}.obj")), QUAD.replace("v 1 1 0", &format!("v 1.00 1 {frame}")))
            .unwrap();
    }
    fs::write(path.join("q.0099.obj"), "a name with other padding").unwrap();
    let cache = VertexCache::open(&path.join("q.###.obj"), &[mesh(path)]).unwrap();
    assert_eq!(cache.frames(), 98..=101);
    assert_eq!(cache.file(98), path.join("q.098.obj"));
    let frame = cache.read(99).unwrap();
    assert_eq!(frame.encode(frame.positions()).unwrap(), fs::read(path.join("q.099.obj")).unwrap());
    let mut moved = frame.positions().to_vec();
    moved[2][2] = 1.5;
    let text = String::from_utf8(frame.encode(&moved).unwrap()).unwrap();
    assert_eq!(text, QUAD.replace("v 1 1 0", "v 1.00 1 1.5"));

    fs::write(path.join("q.100.obj"), QUAD.replace("f 1 2 3 4", "f 2 3 4 1")).unwrap();
    let error = cache.read(100).unwrap_err().to_string();
    assert!(error.contains("q.100.obj: frame 100: face 0 (from 0) has other corners than in the mesh"), "{error}");
    fs::write(path.join("q.100.obj"), QUAD.replace("v 1 1 0", "v 1 1e300 0")).unwrap();
    assert!(cache.read(100).unwrap_err().to_string().contains("vertex 2 (from 0) has coordinate y = 1e300"));
    fs::write(path.join("q.100.obj"), QUAD.replace("v 1 1 0", "v 1 x 0")).unwrap();
    assert!(cache.read(100).unwrap_err().to_string().contains("frame 100: line 3: vertex 3 has `x`"));
    fs::remove_file(path.join("q.100.obj")).unwrap();
    let error = |name: &str| VertexCache::open(&path.join(name), &[mesh(path)]).unwrap_err().to_string();
    assert!(error("q.###.obj").ends_with("q.100.obj: frame 100: is missing, between frames that are there"));
    assert!(error("r.###.obj").ends_with("r.###.obj: no file fits this pattern"));
    assert!(error("#.#.obj").ends_with("more than one run of #"));
    assert!(error("q.###.glb").contains("not a vertex cache; expected .pc2"));
    assert!(error("q.abc").contains("not a vertex cache; expected .pc2"));
}

#[test]
fn caches_that_break_their_promise_are_refused_with_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |name: &str, bytes: &[u8], words: &str| {
        let error = error(folder.path(), name, bytes);
        assert!(error.starts_with(name) && error.ends_with(words) && !error.contains('\n'), "{error}");
    };
    for (name, bytes, counts_at) in [("t.pc2", pc2(3), [28, 16]), ("t.mdd", mdd(3), [0, 4])] {
        let edited = |at: usize, value: u32| {
            let is_little = name == "t.pc2";
            let mut bytes = bytes.clone();
            bytes[at..at + 4].copy_from_slice(&if is_little { value.to_le_bytes() } else { value.to_be_bytes() });
            bytes
        };
        let short = &bytes[..bytes.len() - 60];
        let needed = bytes.len();
        let words = format!(
            ": frame 1: the file ends within this frame; its header promises 3 frames, {needed} bytes; it has {}",
            short.len()
        );
        refuse(name, short, &words);
        refuse(name, &[&bytes[..], b"more"].concat(), ": has 4 bytes after its last frame");
        refuse(name, &edited(counts_at[1], 5), ": has 5 vertices, and the mesh has 4");
        refuse(name, &edited(counts_at[0], 0), ": has no frames");
        refuse(
            name,
            &edited(needed - 4, f32::NAN.to_bits()),
            ": frame 2: vertex 3 (from 0) has coordinate z = NaN; coordinates must be finite and at most 2^250",
        );
        // Lengths that lie cost no memory.
        let lie = error(folder.path(), name, &edited(counts_at[0], i32::MAX.cast_unsigned()));
        assert!(lie.contains("the file ends within this frame; its header promises 2147483647 frames"), "{lie}");
        assert!(error(folder.path(), name, &edited(counts_at[0], u32::MAX)).ends_with("has -1 frames"));
        refuse(name, &bytes[..6], ": ends within its header");
        refuse(name, b"", ": ends within its header");
    }
    refuse("v.pc2", &[&pc2(1)[..12], &[2], &pc2(1)[13..]].concat(), "version 2, and only version 1 is known");
    refuse("w.pc2", &mdd(9), ": is no PC2 file: it does not start with POINTCACHE2");
}
