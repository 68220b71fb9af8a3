//! One mesh file: reading it in any format, and writing it back with other positions.

use std::{
    fs,
    io::Write,
    ops::Range,
    path::{Path, PathBuf},
};

use crate::{
    document::Document,
    error::{ReadError, ReadErrorKind, WriteError},
    file_format::FileFormat,
    formats::{
        gltf::{Container, Destination},
        mesh_data::MeshData,
        obj,
        part::Part,
        polygon::Polygons,
    },
};

/// A mesh file as it was read.
#[derive(Clone, Debug)]
pub struct MeshFile {
    path: PathBuf,
    data: MeshData,
    faces: Vec<[u32; 3]>,
    uv_faces: Option<Vec<[u32; 3]>>,
    document: Document,
}

/// Reads a mesh file. The first bytes tell PLY and GLB, the extension tells the other formats.
///
/// # Errors
/// [`ReadError`], with the file, the line in a text format, and the element at fault.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
    let path = path.as_ref();
    if FileFormat::of_name(path) == Some(FileFormat::Usd) {
        return Err(ReadError { path: path.to_path_buf(), line: None, kind: ReadErrorKind::NeedsPrim });
    }
    let bytes = fs::read(path).map_err(|io| ReadError { path: path.to_path_buf(), line: None, kind: io.into() })?;
    parse_mesh(bytes, path)
}

/// What reading a file of these bytes at `path` gives.
pub(crate) fn parse_mesh(bytes: Vec<u8>, path: &Path) -> Result<MeshFile, ReadError> {
    let error = |(line, kind)| ReadError { path: path.to_path_buf(), line, kind };
    let format = FileFormat::of_content(&bytes)
        .or_else(|| FileFormat::of_name(path))
        .ok_or_else(|| error((None, ReadErrorKind::UnknownFormat)))?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let (data, document) = Document::parse(format, bytes, folder).map_err(error)?;
    MeshFile::new(path, data, document).map_err(|kind| error((None, kind)))
}

impl MeshFile {
    /// The mesh of a stage.
    pub(crate) fn of_stage(path: &Path, data: MeshData) -> Result<Self, ReadErrorKind> {
        Self::new(path, data, Document::Stage)
    }

    fn new(path: &Path, mut data: MeshData, document: Document) -> Result<Self, ReadErrorKind> {
        let MeshData { positions, uv_coordinates, polygons, parts } = &mut data;
        if positions.is_empty() || polygons.is_empty() {
            return Err(ReadErrorKind::Empty { num_vertices: positions.len(), num_faces: polygons.len() });
        }
        for part in parts {
            part.faces = polygons.first_triangle(part.faces.start)..polygons.first_triangle(part.faces.end);
        }
        let (faces, uv_faces) = polygons.triangulate(positions);
        // Some exporters write one point for all corners of a mesh without texture coordinates. That is no map of the
        // cloth.
        let uv_faces =
            uv_faces.filter(|faces| faces.iter().any(|face| has_area(face.map(|uv| uv_coordinates[uv as usize]))));
        Ok(Self { path: path.to_path_buf(), data, faces, uv_faces, document })
    }

    /// The same mesh at other positions, `num_vertices x 3`: as a frame of a cache has them. Polygons stay split as
    /// they are, so that all frames have the same triangles. It is there to be analysed, not to be written.
    ///
    /// # Errors
    /// [`WriteError::Length`].
    pub fn at_positions(&self, positions: &[[f64; 3]]) -> Result<Self, WriteError> {
        let (given, expected) = (positions.len(), self.positions().len());
        if given != expected {
            return Err(WriteError::Length { given, expected });
        }
        let mut file = self.clone();
        file.data.positions.copy_from_slice(positions);
        Ok(file)
    }

    /// The path it was read from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its format.
    #[must_use]
    pub fn format(&self) -> FileFormat {
        self.document.format()
    }

    /// The line of a vertex, counted from 1, in a text format.
    #[must_use]
    pub fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        self.document.line_of_vertex(vertex)
    }

    /// Positions, `num_vertices x 3`, finite; taken as metres.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.data.positions
    }

    /// Texture coordinates, used by [`Polygons::uv_corners`].
    #[must_use]
    pub fn uv_coordinates(&self) -> &[[f64; 2]] {
        &self.data.uv_coordinates
    }

    /// The faces as the file has them.
    #[must_use]
    pub fn polygons(&self) -> &Polygons {
        &self.data.polygons
    }

    /// The faces as triangles, `num_faces x 3`, in the order of the polygons. A convex polygon is the fan of its first
    /// corner, any other is split by clipping ears.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The named parts of the file, in its order: objects and groups of OBJ, nodes and meshes of glTF. What stands
    /// under no name is in none.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.data.parts
    }

    /// The part in which a triangle of [`faces`](Self::faces) stands, if that has a name. Cost: O(log n).
    #[must_use]
    pub fn part_of_face(&self, face: usize) -> Option<&Part> {
        let after = self.data.parts.partition_point(|part| part.faces.end <= face);
        self.data.parts.get(after).filter(|part| part.faces.contains(&face))
    }

    /// The part of each vertex, if there is one, in one pass over the file: that of the first named face that uses it,
    /// else the part in which the vertex itself stands.
    #[must_use]
    pub fn vertex_parts(&self) -> Vec<Option<&Part>> {
        let mut parts = vec![None; self.data.positions.len()];
        for part in &self.data.parts {
            for &vertex in self.faces[part.faces.clone()].as_flattened() {
                parts[vertex as usize].get_or_insert(part);
            }
        }
        for part in &self.data.parts {
            for slot in &mut parts[part.vertices.clone()] {
                slot.get_or_insert(part);
            }
        }
        parts
    }

    /// The texture coordinate indices of the triangles, `num_faces x 3`, if the file maps its faces to an area.
    pub(crate) fn uv_faces(&self) -> Option<&[[u32; 3]]> {
        self.uv_faces.as_deref()
    }

    /// The files that it was read from: its [`path`](Self::path), then the files that a glTF document links.
    pub fn source_files(&self) -> impl Iterator<Item = &Path> {
        let linked = self.document.linked_files().map(PathBuf::as_path);
        std::iter::once(self.path.as_path()).chain(linked)
    }

    /// Whether the file can only hold positions of single precision.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        self.document.is_single_precision()
    }

    /// Ranges of vertices whose positions can't change in this file, each with the reason.
    #[must_use]
    pub fn fixed_vertices(&self) -> Vec<(Range<usize>, &str)> {
        self.document.fixed_vertices()
    }

    /// Writes the file back with other positions in metres, `num_vertices x 3`.
    ///
    /// Every byte stays but those of coordinates that changed, of the bounds of positions in glTF, and of the normals
    /// of facets that moved in STL. A file of single precision gets the nearest single. Of a glTF document with
    /// buffers in files of their own, the buffers that changed become `data:` links; the other links stay, so the
    /// document must be written into the same folder.
    ///
    /// # Errors
    /// [`WriteError`] for a wrong number of positions, for a vertex that moved and is one of
    /// [`fixed_vertices`](Self::fixed_vertices), and for what writing to `out` gives.
    pub fn write_with_positions(&self, positions: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        self.write_to(positions, Destination { container: self.document.container(), same_folder: true }, out)
    }

    /// [`write_with_positions`](Self::write_with_positions) for a file at `path`, whose extension chooses the container
    /// of glTF and whose folder decides whether links of a glTF document still lead to its buffers.
    pub(crate) fn write_for(&self, positions: &[[f64; 3]], path: &Path, out: &mut dyn Write) -> Result<(), WriteError> {
        let is_binary = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb"));
        let container = match &self.document {
            // The name of the input need not tell its format, and under that name its container is kept.
            Document::Gltf(document) if path.file_name() == self.path.file_name() => document.container(),
            _ if is_binary => Container::Binary,
            _ => Container::Text,
        };
        let same_folder = folder_of(path).is_some_and(|folder| folder_of(&self.path) == Some(folder));
        self.write_to(positions, Destination { container, same_folder }, out)
    }

    fn write_to(
        &self,
        positions: &[[f64; 3]],
        destination: Destination,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let before = self.positions();
        if positions.len() != before.len() {
            return Err(WriteError::Length { given: positions.len(), expected: before.len() });
        }
        self.document.write(before, positions, destination, out)
    }

    /// The positions that reading the file gives, once it was written with these.
    pub(crate) fn stored_positions(&self, positions: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        self.document.stored(self.positions(), positions)
    }

    /// The document of an OBJ file.
    pub(crate) fn obj_document(&self) -> Option<&obj::ObjDocument> {
        match &self.document {
            Document::Obj(document) => Some(document),
            Document::Ply(_) | Document::Gltf(_) | Document::Stl(_) | Document::Stage => None,
        }
    }
}

/// The folder of a file, if it exists, with links resolved.
fn folder_of(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    fs::canonicalize(folder.unwrap_or_else(|| Path::new("."))).ok()
}

/// Whether a triangle of texture coordinates has an area.
fn has_area([a, b, c]: [[f64; 2]; 3]) -> bool {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    area.abs() > 0.0
}
