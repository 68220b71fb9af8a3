//! Vertex caches: the positions of a mesh, frame by frame, in PC2, MDD, numbered OBJ or PLY, or USD.
//!
//! Frames are read and written one at a time, in any order; nothing is kept of a frame that was read. A header is
//! checked against the length of its file before anything is allocated.
//!
//! | file | purpose |
//! |---|---|
//! | `error` | why a cache was not read |
//! | `singles` | what PC2 and MDD have in common: frames of single precision in one file |
//! | `pc2`, `mdd` | their headers |
//! | `topology`, `pattern`, `numbered` | a file for each frame |
//! | `frame` | one frame, of any format |
//!
//! A row uses those above it only.

mod error;
mod frame;
mod mdd;
mod numbered;
mod pattern;
mod pc2;
mod singles;
mod topology;

use std::{
    io::{self, Write},
    ops::{Range, RangeInclusive},
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    file_format::FileFormat,
    mesh_file::MeshFile,
    usd::{self, Place, UsdError, UsdShot},
};
pub use error::{CacheError, CacheErrorKind};
pub use frame::CacheFrame;
use frame::Source;
use mdd::Mdd;
use numbered::Numbered;
pub use pattern::Pattern;
use pc2::Pc2;
use topology::Topology;

/// An open vertex cache.
///
/// ```
/// use untangled_mesh_io::{VertexCache, read_mesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let folder = tempfile::tempdir()?;
/// for (frame, height) in [(7, "0"), (8, "1.5")] {
///     let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 {height}\nf 1 2 3\n");
///     std::fs::write(folder.path().join(format!("flag_{frame:03}.obj")), text)?;
/// }
/// let mesh = read_mesh(folder.path().join("flag_007.obj"))?;
/// let cache = VertexCache::open(&folder.path().join("flag_###.obj"), std::slice::from_ref(&mesh))?;
///
/// assert_eq!(cache.frames(), 7..=8);
/// let frame = cache.read(8)?;
/// assert_eq!(frame.positions()[2], [0.0, 1.0, 1.5]);
/// assert_eq!(frame.encode(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 2.0]])?, b"v 0 0 0\nv 1 0 0\nv 0 1 2\nf 1 2 3\n");
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct VertexCache {
    path: PathBuf,
    topology: Topology,
    format: Format,
}

#[derive(Debug)]
enum Format {
    Pc2(Pc2),
    Mdd(Mdd),
    Numbered(Numbered),
    Usd(Box<UsdShot>),
}

impl VertexCache {
    /// Opens a cache of the vertices of `files`, one file after the other. Its name tells the format.
    ///
    /// # Errors
    /// [`CacheError`], with the file and the frame at fault.
    pub fn open(path: &Path, files: &[MeshFile]) -> Result<Self, CacheError> {
        let topology = Topology::of(files);
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        let format = match extension.as_deref() {
            Some("pc2") => Format::Pc2(Pc2::open(path, topology.num_vertices)?),
            Some("mdd") => Format::Mdd(Mdd::open(path, topology.num_vertices)?),
            _ if Pattern::is_meant_by(path)
                && matches!(FileFormat::of_name(path), Some(FileFormat::Obj | FileFormat::Ply)) =>
            {
                Format::Numbered(Numbered::open(path)?)
            }
            _ => {
                return Err(CacheError { path: path.to_path_buf(), frame: None, kind: CacheErrorKind::UnknownFormat });
            }
        };
        Ok(Self { path: path.to_path_buf(), topology, format })
    }

    /// Opens a stage of USD as a cache of the meshes at a prim and below it: its mesh, all prims one after the other at
    /// their positions of the first frame in metres in the world, and the cache.
    ///
    /// # Errors
    /// [`UsdError`], with the layer or the prim at fault.
    pub fn open_usd(path: &Path, prim: &str) -> Result<(MeshFile, Self), UsdError> {
        let (data, shot) = UsdShot::open(path, prim)?;
        let file = MeshFile::of_stage(path, data).map_err(|kind| UsdError {
            path: path.to_path_buf(),
            line: None,
            prim: Some(prim.to_owned()),
            reason: kind.to_string(),
        })?;
        let topology = Topology::of(std::slice::from_ref(&file));
        Ok((file, Self { path: path.to_path_buf(), topology, format: Format::Usd(Box::new(shot)) }))
    }

    /// The path, or the pattern, that it was opened with.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The numbers of its frames: those in the names of files; from 0 in a file that holds all frames.
    #[must_use]
    pub fn frames(&self) -> RangeInclusive<u64> {
        match &self.format {
            Format::Pc2(file) => 0..=file.frames.num_frames() - 1,
            Format::Mdd(file) => 0..=file.frames.num_frames() - 1,
            Format::Numbered(files) => files.frames.clone(),
            Format::Usd(shot) => shot.first()..=shot.first() + shot.num_frames() - 1,
        }
    }

    /// The pattern of numbered meshes; nothing where one file holds all frames.
    #[must_use]
    pub fn pattern(&self) -> Option<&Pattern> {
        match &self.format {
            Format::Numbered(files) => Some(&files.pattern),
            Format::Pc2(_) | Format::Mdd(_) | Format::Usd(_) => None,
        }
    }

    /// The files that it is read from, of frames that are there.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        match &self.format {
            Format::Pc2(_) | Format::Mdd(_) => vec![self.path.clone()],
            Format::Numbered(files) => files.frames.clone().map(|frame| files.pattern.file(frame)).collect(),
            Format::Usd(shot) => shot.files(),
        }
    }

    /// The time code of a frame in USD; nothing in other formats, and where points have no samples.
    #[must_use]
    pub fn time_code(&self, frame: u64) -> Option<f64> {
        match &self.format {
            Format::Usd(shot) => shot.time(frame - shot.first()),
            Format::Pc2(_) | Format::Mdd(_) | Format::Numbered(_) => None,
        }
    }

    /// Whether it is a stage of USD: its output is a layer, which [`write_layer`](Self::write_layer) writes at the end.
    #[must_use]
    pub fn is_usd(&self) -> bool {
        matches!(self.format, Format::Usd(_))
    }

    /// Checks, before frames are worked on, that a layer at a path can name the stage of USD and its prims. Of other
    /// formats there is nothing to check.
    ///
    /// # Errors
    /// In words, what can't be named.
    pub fn check_layer(&self, path: &Path) -> Result<(), String> {
        match &self.format {
            Format::Usd(shot) => shot.check_layer(path),
            Format::Pc2(_) | Format::Mdd(_) | Format::Numbered(_) => Ok(()),
        }
    }

    /// Writes the layer over a stage of USD, as the file at a path: the points of the meshes in a part of the frames,
    /// and the stage as its sublayer. `read` gives the bytes of a frame, as [`CacheFrame::encode`] made them, for a
    /// range of vertices, 12 for each. Of other formats there is nothing to write.
    ///
    /// # Errors
    /// What `read` and `out` give.
    pub fn write_layer(
        &self,
        path: &Path,
        part: &RangeInclusive<u64>,
        read: &mut dyn FnMut(u64, Range<usize>) -> io::Result<Vec<u8>>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        match &self.format {
            Format::Usd(shot) => shot.write_layer(path, part, read, out),
            Format::Pc2(_) | Format::Mdd(_) | Format::Numbered(_) => Ok(()),
        }
    }

    /// The file of a frame.
    #[must_use]
    pub fn file(&self, frame: u64) -> PathBuf {
        self.pattern().map_or_else(|| self.path.clone(), |pattern| pattern.file(frame))
    }

    /// The header of a file with a part of the frames; that of all frames is the one that was read. Empty for numbered
    /// meshes.
    #[must_use]
    pub fn header(&self, part: &RangeInclusive<u64>) -> Vec<u8> {
        match &self.format {
            Format::Pc2(file) => file.header(part),
            Format::Mdd(file) => file.header(part),
            Format::Numbered(_) | Format::Usd(_) => Vec::new(),
        }
    }

    /// Reads one frame.
    ///
    /// # Errors
    /// [`CacheError`], with the file and the frame.
    pub fn read(&self, frame: u64) -> Result<CacheFrame, CacheError> {
        let bytes = match &self.format {
            Format::Pc2(file) => file.frames.bytes(frame),
            Format::Mdd(file) => file.frames.bytes(frame),
            Format::Numbered(files) => return files.read(frame, &self.topology).map(of_mesh),
            Format::Usd(shot) => {
                let read = shot.read(frame - shot.first());
                let (bytes, places) = read.map_err(|error| self.usd_error(frame, error))?;
                return Ok(of_prims(bytes, places));
            }
        };
        let bytes = bytes.map_err(|io| CacheError { path: self.path.clone(), frame: Some(frame), kind: io.into() })?;
        self.decode(frame, bytes)
    }

    /// What reading a frame of these bytes gives; they need not be those of the file.
    ///
    /// # Errors
    /// [`CacheError`], with the file and the frame.
    pub fn decode(&self, frame: u64, bytes: Vec<u8>) -> Result<CacheFrame, CacheError> {
        let order = match &self.format {
            Format::Pc2(file) => file.frames.order(),
            Format::Mdd(file) => file.frames.order(),
            Format::Numbered(files) => return files.parse(frame, bytes, &self.topology).map(of_mesh),
            Format::Usd(shot) => {
                let places = shot.places(frame - shot.first()).map_err(|error| self.usd_error(frame, error))?;
                return Ok(of_prims(bytes, places));
            }
        };
        let positions = singles::decode(&bytes, order).map_err(|kind| CacheError {
            path: self.path.clone(),
            frame: Some(frame),
            kind,
        })?;
        Ok(CacheFrame::new(positions, Source::Singles(bytes, order)))
    }

    fn usd_error(&self, frame: u64, UsdError { path, line, prim, reason }: UsdError) -> CacheError {
        let line = line.map_or_else(String::new, |line| format!("line {line}: "));
        let prim = prim.map_or_else(String::new, |prim| format!("prim {prim}: "));
        CacheError { path, frame: Some(frame), kind: CacheErrorKind::Usd(line + &prim + &reason) }
    }
}

fn of_prims(bytes: Vec<u8>, places: Arc<[Place]>) -> CacheFrame {
    CacheFrame::new(usd::positions(&bytes, &places), Source::Prims(bytes, places))
}

fn of_mesh(file: MeshFile) -> CacheFrame {
    CacheFrame::new(file.positions().to_vec(), Source::Mesh(Box::new(file)))
}
