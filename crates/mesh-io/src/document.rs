//! The bytes of a mesh file in the form of its format, kept to be written back.

use std::{
    io::Write,
    ops::Range,
    path::{Path, PathBuf},
};

use crate::{
    error::{ReadErrorKind, WriteError},
    file_format::FileFormat,
    formats::{
        gltf::{self, Container, Destination},
        mesh_data::MeshData,
        obj, ply, stl,
    },
};

/// A file of any format.
#[derive(Clone, Debug)]
pub(crate) enum Document {
    Obj(obj::ObjDocument),
    Ply(ply::PlyDocument),
    Gltf(gltf::GltfDocument),
    Stl(stl::StlDocument),
    /// None: the mesh stands in a stage, and is written as a layer over it.
    Stage,
}

/// What is wrong, and the line in a text format.
type Refusal = (Option<usize>, ReadErrorKind);

impl Document {
    /// Parses a file of a format; a glTF document finds its buffers from `folder`.
    pub(crate) fn parse(format: FileFormat, bytes: Vec<u8>, folder: &Path) -> Result<(MeshData, Self), Refusal> {
        match format {
            FileFormat::Obj => obj::parse(bytes).map(|(data, document)| (data, Self::Obj(document))),
            FileFormat::Ply => ply::parse(bytes).map(|(data, document)| (data, Self::Ply(document))),
            FileFormat::Gltf => gltf::parse(bytes, folder)
                .map(|(data, document)| (data, Self::Gltf(document)))
                .map_err(|kind| (None, kind)),
            FileFormat::Stl => stl::parse(bytes).map(|(data, document)| (data, Self::Stl(document))),
            FileFormat::Usd => Err((None, ReadErrorKind::NeedsPrim)),
        }
    }

    pub(crate) fn format(&self) -> FileFormat {
        match self {
            Self::Obj(_) => FileFormat::Obj,
            Self::Ply(_) => FileFormat::Ply,
            Self::Gltf(_) => FileFormat::Gltf,
            Self::Stl(_) => FileFormat::Stl,
            Self::Stage => FileFormat::Usd,
        }
    }

    /// The line of a vertex, counted from 1, in a text format.
    pub(crate) fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        match self {
            Self::Obj(document) => document.line_of_vertex(vertex),
            Self::Ply(document) => document.line_of_vertex(vertex),
            Self::Gltf(_) | Self::Stage => None,
            Self::Stl(document) => document.line_of_vertex(vertex),
        }
    }

    /// The files that a glTF document links.
    pub(crate) fn linked_files(&self) -> impl Iterator<Item = &PathBuf> {
        let linked = match self {
            Self::Gltf(document) => Some(document.linked_files()),
            Self::Obj(_) | Self::Ply(_) | Self::Stl(_) | Self::Stage => None,
        };
        linked.into_iter().flatten()
    }

    pub(crate) fn is_single_precision(&self) -> bool {
        match self {
            Self::Obj(_) | Self::Stage => false,
            Self::Ply(document) => document.is_single_precision(),
            Self::Gltf(document) => document.is_single_precision(),
            Self::Stl(document) => document.is_single_precision(),
        }
    }

    /// Ranges of vertices whose positions can't change, each with the reason.
    pub(crate) fn fixed_vertices(&self) -> Vec<(Range<usize>, &str)> {
        match self {
            Self::Obj(_) | Self::Stl(_) | Self::Stage => Vec::new(),
            Self::Ply(document) => document.fixed_vertices().collect(),
            Self::Gltf(document) => document.fixed_vertices().collect(),
        }
    }

    /// The container of glTF that it was read from.
    pub(crate) fn container(&self) -> Container {
        match self {
            Self::Gltf(document) => document.container(),
            Self::Obj(_) | Self::Ply(_) | Self::Stl(_) | Self::Stage => Container::Text,
        }
    }

    /// Writes the file with positions `after` instead of `before`.
    pub(crate) fn write(
        &self,
        before: &[[f64; 3]],
        after: &[[f64; 3]],
        destination: Destination,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        match self {
            Self::Obj(document) => Ok(document.write(before, after, out)?),
            Self::Ply(document) => document.write(before, after, out),
            Self::Gltf(document) => document.write(before, after, destination, out),
            Self::Stl(document) => document.write(before, after, out),
            Self::Stage => Err(WriteError::UnknownFormat),
        }
    }

    /// The positions that reading the file gives, once it was written with `after` instead of `before`.
    pub(crate) fn stored(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        match self {
            Self::Obj(_) | Self::Stage => Ok(after.to_vec()),
            Self::Ply(document) => document.stored(before, after),
            Self::Gltf(document) => document.stored_positions(before, after),
            Self::Stl(document) => document.stored(before, after),
        }
    }
}
