//! Sequences in numpy's compressed format: only as much of it as these files use.

use std::{
    io::{Error, Read},
    path::Path,
};

use flate2::read::DeflateDecoder;

/// A file with `X` (frames x vertices x 3, float32) and `F` (triangles x 3, int32).
#[derive(Clone, Debug)]
pub struct Sequence {
    /// Positions of each frame in metres.
    pub frames: Vec<Vec<[f32; 3]>>,
    /// Vertices of each face.
    pub faces: Vec<[u32; 3]>,
}

impl Sequence {
    /// Reads a file.
    ///
    /// # Errors
    /// The file can't be read, or lacks one of the arrays.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let archive = std::fs::read(path)?;
        let (shape, bytes) = member(&archive, "X.npy")?;
        let points = triples(&bytes, f32::from_le_bytes);
        let frames = points.chunks(shape[1]).map(<[_]>::to_vec).collect();
        let (_, bytes) = member(&archive, "F.npy")?;
        Ok(Self { frames, faces: triples(&bytes, u32::from_le_bytes) })
    }
}

fn triples<T: Copy>(bytes: &[u8], from: impl Fn([u8; 4]) -> T) -> Vec<[T; 3]> {
    let number = |at: usize| from([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    (0..bytes.len() / 12).map(|row| [0, 4, 8].map(|at| number(12 * row + at))).collect()
}

/// Shape and data of one array, found in the archive's directory.
fn member(archive: &[u8], name: &str) -> Result<(Vec<usize>, Vec<u8>), Error> {
    let u16_at = |at: usize| usize::from(u16::from_le_bytes([archive[at], archive[at + 1]]));
    let u32_at = |at: usize| u16_at(at) | u16_at(at + 2) << 16;
    let mut at = archive
        .windows(4)
        .rposition(|bytes| bytes == b"PK\x05\x06")
        .map(|end| u32_at(end + 16))
        .ok_or_else(|| Error::other("no archive"))?;
    while archive[at..].starts_with(b"PK\x01\x02") {
        let (name_len, extra, comment) = (u16_at(at + 28), u16_at(at + 30), u16_at(at + 32));
        if &archive[at + 46..at + 46 + name_len] == name.as_bytes() {
            let (local, packed) = (u32_at(at + 42), u32_at(at + 20));
            let start = local + 30 + u16_at(local + 26) + u16_at(local + 28);
            let mut array = Vec::new();
            DeflateDecoder::new(&archive[start..start + packed]).read_to_end(&mut array)?;
            let header_len = 10 + usize::from(u16::from_le_bytes([array[8], array[9]]));
            let header = String::from_utf8_lossy(&array[10..header_len]).into_owned();
            let shape = header.split(['(', ')']).nth(1).unwrap_or_default();
            let shape = shape.split(',').filter_map(|extent| extent.trim().parse().ok()).collect();
            return Ok((shape, array.split_off(header_len)));
        }
        at += 46 + name_len + extra + comment;
    }
    Err(Error::other(format!("no {name}")))
}
