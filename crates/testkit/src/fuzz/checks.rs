//! What holds for everything that was accepted.

use std::path::Path;

use untangle::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    respond::VertexFlags,
    untangler::Untangler,
};
use untangled_mesh_io::{MeshFile, Output, Printable, VertexCache, read_mesh};

/// No refusal quotes a file at length: characters of it beyond the file's path.
const LONGEST_REFUSAL: usize = 1100;

/// A mesh: its adjacency is consistent.
pub(super) fn check_mesh(mesh: &Mesh) {
    for k in 0..mesh.num_faces() {
        let face = FaceId(k as u32);
        let corners = mesh.face(face);
        // A face with a repeated index is ignored.
        let ignored = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
        for vertex in corners {
            assert!(vertex.index() < mesh.num_vertices());
            assert_eq!(mesh.vertex_faces(vertex).contains(&face), !ignored, "a face is round its corners");
        }
    }
}

/// A frame: its answer is complete, finite, and the same each time.
pub(super) fn check_frame(untangler: &mut Untangler, frame: &Frame) {
    let n = untangler.mesh().num_vertices();
    let outcome = untangler.process(frame, &mut ());
    let (paths, corrections) = (&outcome.analysis.paths, outcome.corrections);
    let num_segments = outcome.analysis.intersections.segments.len();
    assert_eq!(paths.pairs.iter().map(|pair| pair.num_segments).sum::<usize>(), num_segments, "segments on paths");
    for copy in &paths.copies {
        assert_eq!(paths.copies[copy.partner].pair, copy.pair);
    }
    assert_eq!(outcome.analysis.regions.by_copy.len(), paths.copies.len());
    assert_eq!((corrections.forces.len(), corrections.flags.len()), (n, n));
    assert!(corrections.forces.iter().flatten().all(|x| x.is_finite()), "forces are finite");
    let all = VertexFlags::INSIDE.0 | VertexFlags::NEAR_PATH.0 | VertexFlags::CLAMPED.0 | VertexFlags::PINNED.0;
    assert!(corrections.flags.iter().all(|flags| flags.0 & !all == 0));
    assert_eq!(corrections.left_out.num_pairs, 0, "nothing is left out without a limit");
    let first: Vec<_> = corrections.forces.clone();
    let again = untangler.process(frame, &mut ());
    assert!(first == again.corrections.forces, "the same frame, the same answer");
}

/// A mesh file: it is written back byte for byte.
pub(super) fn check_file(file: &MeshFile, bytes: &[u8]) {
    assert!(file.faces().iter().flatten().all(|&corner| (corner as usize) < file.positions().len()));
    let mut written = Vec::new();
    if file.write_with_positions(file.positions(), &mut written).is_ok() {
        assert!(written == bytes, "a file is written back as it was");
    }
    check_moved(file);
}

/// A mesh file with other positions: what is read back is what was meant, or it was refused. Overwrites the file.
fn check_moved(file: &MeshFile) {
    let mut moved = file.positions().to_vec();
    for (vertex, position) in moved.iter_mut().enumerate() {
        position[vertex % 3] = position[vertex % 3] * 0.75 + 0.1 * vertex as f64;
    }
    let output = Output::new(std::slice::from_ref(file), file.path()).expect("a file is written under its own name");
    let mut written = Vec::new();
    if output.write(&moved, &mut written).is_ok() {
        std::fs::write(file.path(), &written).expect("there is room for a small file");
        let read = read_mesh(file.path()).unwrap_or_else(|error| panic!("what was written is read: {error}"));
        output.check_read_back(&moved, &read).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// A stage: its frames are written back bit for bit, and a layer over it brings about what was written, or it is
/// refused. Overwrites the file.
pub(super) fn check_stage(file: &MeshFile, cache: &VertexCache, path: &Path) {
    assert!(file.faces().iter().flatten().all(|&corner| (corner as usize) < file.positions().len()));
    let mut frames = Vec::new();
    for frame in cache.frames() {
        let Ok(read) = cache.read(frame) else { return };
        let mut moved = read.positions().to_vec();
        for (vertex, position) in moved.iter_mut().enumerate() {
            position[vertex % 3] = position[vertex % 3] * 0.75 + 0.1 * vertex as f64;
        }
        let bytes = read.encode(read.positions()).expect("a frame is written as it was read");
        let Ok(stored) = read.stored_positions(&moved) else { return };
        let back = cache.decode(frame, read.encode(&moved).expect("what is stored is written")).expect("it is read");
        let bits = |positions: &[[f64; 3]]| positions.iter().map(|place| place.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(back.positions()), bits(&stored), "a frame is read as it was stored");
        frames.push(bytes);
    }
    let first = *cache.frames().start();
    let mut points = |frame: u64, vertices: std::ops::Range<usize>| {
        Ok(frames[(frame - first) as usize][12 * vertices.start..12 * vertices.end].to_vec())
    };
    let mut layer = Vec::new();
    cache.write_layer(path, &cache.frames(), &mut points, &mut layer).expect("it is written to memory");
    assert!(layer.starts_with(b"#usda 1.0"));
}

/// The refusal of a file: one line that a terminal may show, which names the file and says more than that.
pub(super) fn check_refusal(words: &str, path: &Path) {
    let path = path.display().to_string();
    assert_eq!(Printable(words).to_string(), words, "a refusal is one line that a terminal may show");
    assert!(words.contains(&path) && words.len() > path.len() + 5, "a refusal names file and fault: {words}");
    let length = words.chars().count() - path.chars().count();
    assert!(length < LONGEST_REFUSAL, "a refusal of {length} characters: {words}");
}
