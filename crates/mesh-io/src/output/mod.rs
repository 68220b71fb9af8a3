//! Writing one or several files as one file, in any format that can hold them.

mod obj;
mod ply;
mod read_back;

use std::{
    io::Write,
    ops::Range,
    path::{Path, PathBuf},
};

use crate::{error::WriteError, file_format::FileFormat, mesh_file::MeshFile};

pub use obj::write_obj;
pub use ply::write_ply;

/// One or several files that are to be written as one, in the format that its name chooses.
///
/// | from | to | what is kept |
/// |---|---|---|
/// | one file | its own format | every byte but those of coordinates that changed, and of bounds in glTF |
/// | one STL | STL | every byte but those of coordinates that changed, and of normals of facets that moved |
/// | `.gltf`, `.glb` | each other | the text but for links of buffers |
/// | OBJ files | one OBJ | every line; indices in `f`, `l`, `p` are shifted |
/// | anything else | OBJ, PLY | vertices, polygons, texture coordinates |
#[derive(Clone, Debug)]
pub struct Output<'a> {
    files: &'a [MeshFile],
    path: PathBuf,
    format: FileFormat,
}

impl<'a> Output<'a> {
    /// Plans to write `files`, one or more, in their order to `path`. Nothing is written yet.
    ///
    /// # Errors
    /// [`WriteError::UnknownFormat`], [`WriteError::OnlyFromGltf`], [`WriteError::OnlyFromStl`].
    pub fn new(files: &'a [MeshFile], path: &Path) -> Result<Self, WriteError> {
        // The name of one input need not tell its format, and is kept as it is.
        let own = files.first().filter(|file| files.len() == 1 && file.path().file_name() == path.file_name());
        let format =
            own.map(MeshFile::format).or_else(|| FileFormat::of_name(path)).ok_or(WriteError::UnknownFormat)?;
        let output = Self { files, path: path.to_path_buf(), format };
        match format {
            FileFormat::Gltf if output.patched().is_none() => Err(WriteError::OnlyFromGltf),
            FileFormat::Usd => Err(WriteError::UnknownFormat),
            FileFormat::Stl if output.patched().is_none() => Err(WriteError::OnlyFromStl),
            _ => Ok(output),
        }
    }

    /// The files.
    #[must_use]
    pub fn files(&self) -> &'a [MeshFile] {
        self.files
    }

    /// The one file whose coordinates are replaced, where nothing else needs to change.
    fn patched(&self) -> Option<&'a MeshFile> {
        self.files.first().filter(|file| self.files.len() == 1 && file.format() == self.format)
    }

    /// Whether the file can only hold positions of single precision.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        self.patched().is_some_and(MeshFile::is_single_precision)
    }

    /// Ranges of vertices, counted over all files, whose positions can't change, each with the reason.
    #[must_use]
    pub fn fixed_vertices(&self) -> Vec<(Range<usize>, &'a str)> {
        self.patched().map(MeshFile::fixed_vertices).unwrap_or_default()
    }

    /// Writes the files with other positions in metres, `num_vertices x 3`, those of all files one after the other.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn write(&self, positions: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        self.check_length(positions)?;
        match (self.patched(), self.format) {
            (Some(file), _) => file.write_for(positions, &self.path, out),
            (None, FileFormat::Ply) => Ok(write_ply(self.files, positions, out)?),
            (None, _) => write_obj(self.files, positions, out),
        }
    }

    fn check_length(&self, positions: &[[f64; 3]]) -> Result<(), WriteError> {
        let (given, expected) = (positions.len(), self.files.iter().map(|file| file.positions().len()).sum());
        if given == expected { Ok(()) } else { Err(WriteError::Length { given, expected }) }
    }
}
