//! One part: its header, checked against the length of its file, and its frames as bytes.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use super::error::JoinError;

const PC2_MAGIC: &[u8; 12] = b"POINTCACHE2\0";
const PC2_SIZE: usize = 32;
const MDD_SIZE: usize = 8;

/// Formats that hold all frames in one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Pc2,
    Mdd,
}

impl Format {
    pub(super) fn extension(self) -> &'static str {
        match self {
            Self::Pc2 => "pc2",
            Self::Mdd => "mdd",
        }
    }
}

/// An open part.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) path: PathBuf,
    pub(super) format: Format,
    pub(super) num_frames: u64,
    pub(super) num_vertices: u32,
    file: File,
    /// All before the frames.
    header: Vec<u8>,
}

/// The extension of a path in small letters; empty without one.
pub(super) fn extension(path: &Path) -> String {
    path.extension().map(|name| name.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

impl Part {
    /// Opens a part, whose name tells the format.
    pub(super) fn open(path: &Path) -> Result<Self, JoinError> {
        let error = |reason: &dyn ToString| JoinError::of(path, reason.to_string());
        let format = match extension(path).as_str() {
            "pc2" => Format::Pc2,
            "mdd" => Format::Mdd,
            _ => return Err(error(&"is neither .pc2 nor .mdd; numbered meshes need no joining")),
        };
        let mut file = File::open(path).map_err(|source| error(&source))?;
        let length = file.metadata().map_err(|source| error(&source))?.len();
        let mut start = vec![0; if format == Format::Pc2 { PC2_SIZE } else { MDD_SIZE }];
        file.read_exact(&mut start).map_err(|_| error(&"is too short for its header"))?;
        let (num_frames, num_vertices) = match format {
            Format::Pc2 if !start.starts_with(PC2_MAGIC) => return Err(error(&"does not start with POINTCACHE2")),
            Format::Pc2 => (u32::from_le_bytes(word(&start, 28)), u32::from_le_bytes(word(&start, 16))),
            Format::Mdd => (u32::from_be_bytes(word(&start, 0)), u32::from_be_bytes(word(&start, 4))),
        };
        let num_frames = u64::from(num_frames);
        let num_times = if format == Format::Mdd { 4 * num_frames } else { 0 };
        let before_frames = start.len() as u64 + num_times;
        // The length is checked before memory is taken for times that a header only claims.
        let expected = u128::from(before_frames) + 12 * u128::from(num_frames) * u128::from(num_vertices);
        if num_frames == 0 || num_vertices == 0 || u128::from(length) != expected {
            let promised = format!("{num_frames} frames of {num_vertices} vertices");
            return Err(error(&format!("has {length} bytes, and its header promises {promised}: {expected} bytes")));
        }
        let mut times = Vec::new();
        let read = (&file).take(num_times).read_to_end(&mut times);
        read.map_err(|source| error(&source))?;
        let header = [start, times].concat();
        Ok(Self { path: path.to_path_buf(), format, num_frames, num_vertices, file, header })
    }

    /// Its frames, from the first on; read once.
    pub(super) fn frames(&self) -> impl Read {
        &self.file
    }

    /// When its first and its last frame are.
    pub(super) fn times(&self) -> [f64; 2] {
        match self.format {
            Format::Pc2 => {
                let [start, rate] = self.pc2_times();
                #[expect(clippy::cast_precision_loss, reason = "counts of frames are far below 2^52")]
                let last = start + rate * (self.num_frames - 1) as f64;
                [start, last]
            }
            Format::Mdd => {
                [MDD_SIZE, self.header.len() - 4].map(|at| f32::from_be_bytes(word(&self.header, at)).into())
            }
        }
    }

    /// The time from one frame to the next, where all of them have the same.
    pub(super) fn step(&self) -> Option<f64> {
        (self.format == Format::Pc2).then(|| self.pc2_times()[1]).filter(|step| *step > 0.0)
    }

    /// Start and rate in the header of a PC2 file.
    fn pc2_times(&self) -> [f64; 2] {
        [20, 24].map(|at| f64::from(f32::from_le_bytes(word(&self.header, at))))
    }
}

/// The header of all parts together: that of the first one, with all frames and their times.
pub(super) fn header(parts: &[Part]) -> Result<Vec<u8>, JoinError> {
    let first = &parts[0];
    let total: u64 = parts.iter().map(|part| part.num_frames).sum();
    let too_many = |_| JoinError::of(&first.path, format!("{total} frames are too many for one file"));
    let total = u32::try_from(total).map_err(too_many)?;
    Ok(match first.format {
        Format::Pc2 => [&first.header[..28], &total.to_le_bytes()].concat(),
        Format::Mdd => {
            let times = parts.iter().flat_map(|part| &part.header[MDD_SIZE..]).copied();
            total.to_be_bytes().into_iter().chain(first.header[4..MDD_SIZE].iter().copied()).chain(times).collect()
        }
    })
}

fn word(bytes: &[u8], at: usize) -> [u8; 4] {
    std::array::from_fn(|byte| bytes[at + byte])
}
