//! Files that hold the positions of all frames in single precision, one frame after the other.

use std::{
    fs::File,
    io,
    os::unix::fs::FileExt,
    path::{Path, PathBuf},
};

use super::error::CacheErrorKind;

/// Bytes of one vertex.
const VERTEX_SIZE: usize = 12;

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    pub(super) fn single(self, bytes: [u8; 4]) -> f32 {
        match self {
            Self::Little => f32::from_le_bytes(bytes),
            Self::Big => f32::from_be_bytes(bytes),
        }
    }

    fn bytes(self, value: f32) -> [u8; 4] {
        match self {
            Self::Little => value.to_le_bytes(),
            Self::Big => value.to_be_bytes(),
        }
    }
}

/// An open file and where its frames are.
#[derive(Debug)]
pub(super) struct Frames {
    file: File,
    order: ByteOrder,
    num_vertices: usize,
    num_frames: u64,
    /// Bytes before the first frame.
    header_size: u64,
}

/// A file that was opened, and its length.
pub(super) fn open(path: &Path) -> Result<(File, u64), CacheErrorKind> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file").into());
    }
    Ok((file, metadata.len()))
}

/// Reads bytes of a header; their number is bounded by the caller.
pub(super) fn header_bytes(file: &File, size: usize, length: u64) -> Result<Vec<u8>, CacheErrorKind> {
    if length < size as u64 {
        return Err(CacheErrorKind::Header("ends within its header".to_owned()));
    }
    let mut bytes = vec![0; size];
    file.read_exact_at(&mut bytes, 0)?;
    Ok(bytes)
}

/// What a header promises.
#[derive(Clone, Copy, Debug)]
pub(super) struct Promise {
    pub(super) num_vertices: u64,
    pub(super) num_frames: u64,
    pub(super) header_size: u64,
}

impl Promise {
    /// Checks what a header promises against the mesh and the length of the file, before anything is allocated. An
    /// error comes with the frame at fault.
    pub(super) fn check(self, expected: usize, length: u64) -> Result<(), (Option<u64>, CacheErrorKind)> {
        let Self { num_vertices, num_frames, header_size } = self;
        if num_frames == 0 {
            return Err((None, CacheErrorKind::NoFrames));
        }
        if num_vertices != expected as u64 {
            return Err((None, CacheErrorKind::NumVertices { given: num_vertices, expected }));
        }
        let frame_size = u128::from(num_vertices) * VERTEX_SIZE as u128;
        let needed = u128::from(header_size) + frame_size * u128::from(num_frames);
        if u128::from(length) < needed {
            let complete = u128::from(length.saturating_sub(header_size)) / frame_size.max(1);
            let frame = u64::try_from(complete).unwrap_or(u64::MAX);
            return Err((Some(frame), CacheErrorKind::Truncated { num_frames, needed, given: length }));
        }
        let longer = u128::from(length) - needed;
        if longer > 0 {
            return Err((None, CacheErrorKind::Longer(u64::try_from(longer).unwrap_or(u64::MAX))));
        }
        Ok(())
    }
}

impl Frames {
    /// Frames of a file whose header was checked.
    pub(super) fn new(file: File, order: ByteOrder, num_vertices: usize, promise: Promise) -> Self {
        Self { file, order, num_vertices, num_frames: promise.num_frames, header_size: promise.header_size }
    }

    pub(super) fn num_frames(&self) -> u64 {
        self.num_frames
    }

    pub(super) fn frame_size(&self) -> usize {
        self.num_vertices * VERTEX_SIZE
    }

    /// The bytes of one frame.
    pub(super) fn bytes(&self, frame: u64) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; self.frame_size()];
        self.file.read_exact_at(&mut bytes, self.header_size + frame * self.frame_size() as u64)?;
        Ok(bytes)
    }

    pub(super) fn order(&self) -> ByteOrder {
        self.order
    }
}

/// The positions that the bytes of a frame hold.
pub(super) fn decode(bytes: &[u8], order: ByteOrder) -> Result<Vec<[f64; 3]>, CacheErrorKind> {
    let (vertices, _) = bytes.as_chunks::<VERTEX_SIZE>();
    let position = |(vertex, bytes): (usize, &[u8; VERTEX_SIZE])| {
        let mut position = [0.0; 3];
        for ((slot, bytes), axis) in position.iter_mut().zip(bytes.as_chunks::<4>().0).zip(['x', 'y', 'z']) {
            let value = f64::from(order.single(*bytes));
            if !value.is_finite() {
                return Err(CacheErrorKind::NotFinite { vertex, axis, value });
            }
            *slot = value;
        }
        Ok(position)
    };
    vertices.iter().enumerate().map(position).collect()
}

/// A coordinate as a frame stores it; nothing beyond single precision.
pub(super) fn rounded(value: f64) -> Option<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
    let single = value as f32;
    single.is_finite().then(|| f64::from(single))
}

/// Replaces the coordinates of a frame that changed, and no other byte. `after` is rounded already.
pub(super) fn replace(bytes: &mut [u8], order: ByteOrder, before: &[[f64; 3]], after: &[[f64; 3]]) {
    let slots = bytes.as_chunks_mut::<4>().0.iter_mut();
    let values = before.as_flattened().iter().zip(after.as_flattened());
    for (slot, (before, after)) in slots.zip(values) {
        if before.to_bits() != after.to_bits() {
            #[expect(clippy::cast_possible_truncation, reason = "it is a single already")]
            let single = *after as f32;
            *slot = order.bytes(single);
        }
    }
}

/// A path and the error of it.
pub(super) fn at(path: &Path) -> impl Fn((Option<u64>, CacheErrorKind)) -> super::error::CacheError {
    let path: PathBuf = path.to_path_buf();
    move |(frame, kind)| super::error::CacheError { path: path.clone(), frame, kind }
}
