//! Why a vertex cache was not read.

use std::path::PathBuf;

use thiserror::Error;

use crate::{
    error::{ReadError, ReadErrorKind},
    printable::{Printable, Reason},
};

/// A vertex cache that can't be read, and the frame at fault.
#[derive(Debug, Error)]
#[error(
    "{}{}: {}",
    Printable(path.display()), frame.map_or(String::new(), |frame| format!(": frame {frame}")), Reason(kind)
)]
pub struct CacheError {
    /// The file, or the pattern of numbered files, as its caller named it.
    pub path: PathBuf,
    /// The frame at fault: the number in the file's name, or counted from 0 in a file that holds all frames.
    pub frame: Option<u64>,
    /// What is wrong.
    #[source]
    pub kind: CacheErrorKind,
}

/// What is wrong with a cache.
#[derive(Debug, Error)]
pub enum CacheErrorKind {
    /// The file can't be opened or read.
    #[error("can't be read: {0}")]
    Io(#[from] std::io::Error),
    /// The name tells no format.
    #[error("not a vertex cache; expected .pc2, .mdd, or numbered .obj or .ply by a pattern as cloth_####.obj")]
    UnknownFormat,
    /// A pattern that is not understood.
    #[error("{0}")]
    Pattern(&'static str),
    /// No file fits a pattern.
    #[error("no file fits this pattern")]
    NoMatch,
    /// A number is left out.
    #[error("is missing, between frames that are there")]
    Gap,
    /// A header that breaks the rules of its format.
    #[error("{0}")]
    Header(String),
    /// A cache without frames.
    #[error("has no frames")]
    NoFrames,
    /// The file ends before its last frame does.
    #[error("the file ends within this frame; its header promises {num_frames} frames, {needed} bytes; it has {given}")]
    Truncated {
        /// Frames that the header promises.
        num_frames: u64,
        /// Bytes that they need.
        needed: u128,
        /// Bytes of the file.
        given: u64,
    },
    /// The file goes on after its last frame.
    #[error("has {0} bytes after its last frame")]
    Longer(u64),
    /// Other vertices than the topology has.
    #[error("has {given} vertices, and the mesh has {expected}")]
    NumVertices {
        /// Vertices of the cache.
        given: u64,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// NaN, infinite, or too large for exact arithmetic.
    #[error("vertex {vertex} (from 0) has coordinate {axis} = {value:e}; coordinates must be finite and at most 2^250")]
    NotFinite {
        /// The vertex, from 0.
        vertex: usize,
        /// `x`, `y` or `z`.
        axis: char,
        /// The value at fault.
        value: f64,
    },
    /// A numbered mesh that is none.
    #[error("{}{kind}", line.map_or(String::new(), |line| format!("line {line}: ")))]
    Mesh {
        /// Line at fault, counted from 1, in a text format.
        line: Option<usize>,
        /// What is wrong.
        kind: Box<ReadErrorKind>,
    },
    /// A numbered mesh with other faces.
    #[error("has {given} faces, and the mesh has {expected}")]
    NumFaces {
        /// Faces of the file, polygons counted once.
        given: usize,
        /// Faces of the mesh.
        expected: usize,
    },
    /// A numbered mesh whose faces have other corners.
    #[error("face {0} (from 0) has other corners than in the mesh: all frames must have its connectivity")]
    OtherFace(usize),
    /// A prim that has no points there, or not those of the mesh.
    #[error("{0}")]
    Usd(String),
    /// A range of frames that the cache does not hold.
    #[error("there are frames {first} to {last}")]
    OutOfRange {
        /// First frame of the cache.
        first: u64,
        /// Last frame.
        last: u64,
    },
}

impl From<ReadError> for CacheErrorKind {
    fn from(ReadError { line, kind, .. }: ReadError) -> Self {
        Self::Mesh { line, kind: Box::new(kind) }
    }
}
