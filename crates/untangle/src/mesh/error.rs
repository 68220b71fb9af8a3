//! Why a mesh was refused.

use thiserror::Error;

/// What is wrong with a [`MeshDescription`](super::MeshDescription), with the element at fault.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// No vertices or no faces.
    #[error("the mesh is empty: {num_vertices} vertices, {num_faces} faces")]
    Empty {
        /// Vertices given.
        num_vertices: usize,
        /// Faces given.
        num_faces: usize,
    },
    /// More elements than 31-bit indices can name.
    #[error("the mesh has {count} {what}; at most {limit} are supported")]
    TooLarge {
        /// Which elements.
        what: &'static str,
        /// How many were given.
        count: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// A face names a vertex that is not there.
    #[error("face {face} has vertex index {index}, but there are only {num_vertices} vertices")]
    VertexIndex {
        /// The face at fault.
        face: usize,
        /// The index that it names.
        index: u32,
        /// Vertices given.
        num_vertices: usize,
    },
    /// A face has corners of a body, and others.
    #[error("face {face} has vertices of a body and of a cloth; a face belongs to one of them")]
    MixedFace {
        /// The face at fault.
        face: usize,
    },
    /// All faces repeat an index.
    #[error("none of the {num_faces} faces has three different vertices")]
    NoUsableFace {
        /// Faces given.
        num_faces: usize,
    },
    /// An optional section has the wrong length.
    #[error("section `{section}` has {given} entries, expected {expected}")]
    SectionLength {
        /// Name of the section.
        section: &'static str,
        /// Entries given.
        given: usize,
        /// Entries expected.
        expected: usize,
    },
    /// An index in an optional section is out of range.
    #[error("section `{section}`, entry {entry}: index {index} is out of range, there are {limit}")]
    SectionIndex {
        /// Name of the section.
        section: &'static str,
        /// Which entry.
        entry: usize,
        /// The index at fault.
        index: u32,
        /// Number of elements that exist.
        limit: usize,
    },
    /// A number in an optional section can't be used.
    #[error("section `{section}`, entry {entry}: {value} is not {expected}")]
    SectionValue {
        /// Name of the section.
        section: &'static str,
        /// Which entry.
        entry: usize,
        /// The value at fault.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
}
