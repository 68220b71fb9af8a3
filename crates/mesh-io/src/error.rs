//! Why a file was not read or not written.

use std::path::PathBuf;

use thiserror::Error;

use crate::printable::{Printable, Reason};

/// A file that can't be read as a mesh, and where in it.
#[derive(Debug, Error)]
#[error(
    "{}{}: {}",
    Printable(path.display()), line.map_or(String::new(), |line| format!(":{line}")), Reason(kind)
)]
pub struct ReadError {
    /// The file, as its caller named it.
    pub path: PathBuf,
    /// Line at fault, counted from 1, in a text format.
    pub line: Option<usize>,
    /// What is wrong.
    #[source]
    pub kind: ReadErrorKind,
}

/// What is wrong with a file. Vertices and faces are counted as their format does: from 1 in OBJ, from 0 elsewhere.
#[derive(Debug, Error)]
pub enum ReadErrorKind {
    /// The file can't be opened or read.
    #[error("can't be read: {0}")]
    Io(#[from] std::io::Error),
    /// Neither the name nor the first bytes tell the format.
    #[error("not a known mesh format; expected OBJ, PLY, STL, glTF, GLB or USD")]
    UnknownFormat,
    /// USD, of which the prim is not known.
    #[error("USD is read with --prim PATH, the path of the cloth in it, as the one FILE; export bodies as meshes")]
    NeedsPrim,
    /// No vertices or no faces.
    #[error("no mesh in it: {num_vertices} vertices, {num_faces} faces")]
    Empty {
        /// Vertices in the file.
        num_vertices: usize,
        /// Faces in the file.
        num_faces: usize,
    },
    /// A token that is not a number.
    #[error("{element} has `{text}` where a number is needed")]
    NotANumber {
        /// Which element.
        element: String,
        /// The token, shortened.
        text: String,
    },
    /// NaN or infinite.
    #[error("{element} has coordinate {value}; coordinates must be finite")]
    NotFinite {
        /// Which element.
        element: String,
        /// The value at fault.
        value: f64,
    },
    /// Too few numbers.
    #[error("{element} has {given} coordinates, at least {needed} are needed")]
    TooFewCoordinates {
        /// Which element.
        element: String,
        /// How many there are.
        given: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A polygon of fewer than three corners.
    #[error("{element} has {given} corners, at least 3 are needed")]
    TooFewCorners {
        /// Which element.
        element: String,
        /// How many there are.
        given: usize,
    },
    /// A token that is not an index.
    #[error("{element} has `{text}` where an index is needed")]
    NotAnIndex {
        /// Which element.
        element: String,
        /// The token, shortened.
        text: String,
    },
    /// An index of an element that does not exist.
    #[error("{element} refers to {what} {index}, but only {defined} are defined")]
    OutOfRange {
        /// Which element.
        element: String,
        /// What is referred to.
        what: &'static str,
        /// The index as the file has it.
        index: i64,
        /// How many there are.
        defined: usize,
    },
    /// The file ends too early.
    #[error("ends within {element}")]
    Truncated {
        /// Which element.
        element: String,
    },
    /// A header or document that breaks the rules of its format.
    #[error("{0}")]
    Malformed(String),
    /// What should be a glTF document and is none.
    #[error("not a valid glTF document: {0}")]
    Gltf(String),
    /// A glTF document that cannot be read without an extension.
    #[error("needs the glTF extension {name}: {reason}")]
    Extension {
        /// Its name.
        name: String,
        /// Why that matters, and what to do.
        reason: String,
    },
    /// A glTF document that asks for more than its bytes could hold.
    #[error("asks for more mesh than its {num_bytes} bytes may: {factor} bytes of mesh for each byte of the file")]
    Amplified {
        /// Bytes of the file and of its buffers.
        num_bytes: usize,
        /// How many bytes of mesh each of them may ask for.
        factor: usize,
    },
}

/// Why a file was not written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The file can't be written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The name of the file does not tell a format.
    #[error("meshes are written as .obj, .ply, .stl, .gltf or .glb")]
    UnknownFormat,
    /// glTF holds neither polygons nor several documents, and needs data that other formats don't have.
    #[error("glTF is only written from one glTF file; write .obj or .ply")]
    OnlyFromGltf,
    /// STL has no vertices that faces share, so that what is read back would be counted otherwise.
    #[error("STL is only written from one STL file; write .obj or .ply")]
    OnlyFromStl,
    /// The number of positions is not the number of vertices.
    #[error("{given} positions were given for {expected} vertices")]
    Length {
        /// Positions given.
        given: usize,
        /// Vertices of the file.
        expected: usize,
    },
    /// The file stores coordinates in a form that can't hold new ones.
    #[error("vertex {vertex} can't be moved in this file: {reason}")]
    FixedCoordinates {
        /// The vertex, from 0.
        vertex: usize,
        /// Why.
        reason: String,
    },
    /// A file that was read back is not what was meant to be written.
    #[error("what was written does not read back as it was meant: {0}")]
    ReadBack(String),
    /// A line of an OBJ has indices of unknown meaning, which can't be shifted.
    #[error("{}:{line}: `{keyword}` can't be joined to other files", Printable(path.display()))]
    Join {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// Its first word.
        keyword: String,
    },
}
