//! STL, ascii and binary.
//!
//! A facet has three corners of its own: corners in exactly one place are one vertex, counted by their first corner.
//! Facets of which two corners are in one place are no faces, but stay in the file. Normals, colours and names are kept
//! when the file is written back, but for the normals of facets that moved.

mod facet;
mod read_ascii;
mod read_binary;
mod write;

use crate::{error::ReadErrorKind, formats::mesh_data::MeshData};

pub(crate) use write::StlDocument;

/// Parses a whole file. An error comes with its line.
pub(crate) fn parse(source: Vec<u8>) -> Result<(MeshData, StlDocument), (Option<usize>, ReadErrorKind)> {
    if read_binary::is_binary(&source) {
        read_binary::parse(source).map_err(|kind| (None, kind))
    } else {
        read_ascii::parse(source)
    }
}
