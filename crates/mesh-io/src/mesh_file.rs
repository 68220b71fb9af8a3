//! What all formats come down to, and several files as one world.

use std::{
    fs,
    io::Write,
    ops::Range,
    path::{Path, PathBuf},
};

use super::{ReadError, ReadErrorKind, WriteError, gltf, obj, ply, polygon::Polygons};
use untangle::mesh::{MeshDescription, Uvs};

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Wavefront OBJ.
    Obj,
    /// PLY, ascii or binary.
    Ply,
    /// glTF 2.0, as `.gltf` with its buffers or as `.glb`.
    Gltf,
}

impl FileFormat {
    /// The format that a file name stands for.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }

    /// The format that the first bytes of a file show. OBJ has no mark of its own.
    fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r\n") {
            Some(Self::Ply)
        } else if bytes.starts_with(b"glTF") {
            Some(Self::Gltf)
        } else {
            None
        }
    }
}

/// What a parser finds in a file.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) uv_coordinates: Vec<[f64; 2]>,
    pub(super) polygons: Polygons,
}

/// The file behind a mesh, kept to be written back.
#[derive(Clone, Debug)]
enum Document {
    Obj(obj::ObjDocument),
    Ply(ply::PlyDocument),
    Gltf(gltf::GltfDocument),
}

/// A mesh file as it was read.
#[derive(Clone, Debug)]
pub struct MeshFile {
    path: PathBuf,
    positions: Vec<[f64; 3]>,
    uv_coordinates: Vec<[f64; 2]>,
    polygons: Polygons,
    faces: Vec<[u32; 3]>,
    uv_faces: Option<Vec<[u32; 3]>>,
    document: Document,
}

/// Reads a mesh file; the name tells the format, or else the first bytes do.
///
/// # Errors
/// [`ReadError`], with the file, the line in a text format, and the element at fault.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<MeshFile, ReadError> {
    let path = path.as_ref();
    let error = |(line, kind)| ReadError { path: path.to_path_buf(), line, kind };
    let bytes = fs::read(path).map_err(|io| error((None, io.into())))?;
    let format = FileFormat::of_content(&bytes)
        .or_else(|| FileFormat::of_name(path))
        .ok_or_else(|| error((None, ReadErrorKind::UnknownFormat)))?;
    let (parsed, document) = match format {
        FileFormat::Obj => obj::parse(bytes).map(|(parsed, document)| (parsed, Document::Obj(document))),
        FileFormat::Ply => ply::parse(bytes).map(|(parsed, document)| (parsed, Document::Ply(document))),
        FileFormat::Gltf => {
            let parsed = gltf::parse(bytes, path.parent()).map_err(|kind| (None, kind));
            parsed.map(|(parsed, document)| (parsed, Document::Gltf(document)))
        }
    }
    .map_err(error)?;
    MeshFile::new(path, parsed, document).map_err(|kind| error((None, kind)))
}

impl MeshFile {
    fn new(path: &Path, parsed: Parsed, document: Document) -> Result<Self, ReadErrorKind> {
        let Parsed { positions, uv_coordinates, polygons } = parsed;
        if positions.is_empty() || polygons.is_empty() {
            return Err(ReadErrorKind::Empty { num_vertices: positions.len(), num_faces: polygons.len() });
        }
        let (faces, uv_faces) = polygons.triangulate(&positions);
        // Exporters without texture coordinates write one point for all corners: that is no map of the cloth.
        let uv_faces =
            uv_faces.filter(|faces| faces.iter().any(|face| has_area(face.map(|uv| uv_coordinates[uv as usize]))));
        Ok(Self { path: path.to_path_buf(), positions, uv_coordinates, polygons, faces, uv_faces, document })
    }

    /// Where it was read from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its format.
    #[must_use]
    pub fn format(&self) -> FileFormat {
        match self.document {
            Document::Obj(_) => FileFormat::Obj,
            Document::Ply(_) => FileFormat::Ply,
            Document::Gltf(_) => FileFormat::Gltf,
        }
    }

    /// The line in which a vertex stands, from 1, if the file is text.
    #[must_use]
    pub fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        match &self.document {
            Document::Obj(document) => document.line_of_vertex(vertex),
            Document::Ply(document) => document.line_of_vertex(vertex),
            Document::Gltf(_) => None,
        }
    }

    /// Positions, `num_vertices x 3`, finite; taken as metres.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Texture coordinates, used by [`Polygons::uv_corners`].
    #[must_use]
    pub fn uv_coordinates(&self) -> &[[f64; 2]] {
        &self.uv_coordinates
    }

    /// The faces as they stand in the file.
    #[must_use]
    pub fn polygons(&self) -> &Polygons {
        &self.polygons
    }

    /// The faces as triangles, `num_faces x 3`, in the order of the polygons: the first corner's fan of a convex polygon, clipped ears of
    /// any other.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The files that it was read from: the one of its [`path`](Self::path), and those that a glTF document links.
    pub fn source_files(&self) -> impl Iterator<Item = &Path> {
        let linked = match &self.document {
            Document::Gltf(document) => Some(document.linked_files()),
            Document::Obj(_) | Document::Ply(_) => None,
        };
        std::iter::once(self.path.as_path()).chain(linked.into_iter().flatten().map(PathBuf::as_path))
    }

    /// Whether the file can only hold positions of single precision.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        match &self.document {
            Document::Obj(_) => false,
            Document::Ply(document) => document.is_single_precision(),
            Document::Gltf(document) => document.is_single_precision(),
        }
    }

    /// Vertices that can't have other positions in this file, in ranges, each with the reason.
    #[must_use]
    pub fn fixed_vertices(&self) -> Vec<(Range<usize>, &str)> {
        match &self.document {
            Document::Obj(_) => Vec::new(),
            Document::Ply(document) => {
                document.fixed().map(|reason| (0..self.positions.len(), reason)).into_iter().collect()
            }
            Document::Gltf(document) => document.fixed_vertices().collect(),
        }
    }

    /// Writes the file back with other positions in metres, `num_vertices x 3`. All else stays byte for byte; where a position
    /// is what it was, so do its digits. A file that holds single precision gets the nearest single. A glTF document with buffers in
    /// files of their own gets those that changed as `data:` links; it links the others still.
    ///
    /// # Errors
    /// [`WriteError`] for a wrong number of positions, for a vertex that moved and is one of [`fixed_vertices`](Self::fixed_vertices), and for what
    /// writing to `out` gives.
    pub fn write_with_positions(&self, positions: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        let container = match &self.document {
            Document::Gltf(document) => document.container(),
            Document::Obj(_) | Document::Ply(_) => gltf::Container::Text,
        };
        self.write_in(positions, container, true, out)
    }

    /// [`write_with_positions`](Self::write_with_positions) for a name and a folder, which say in what form glTF is written and whether
    /// links of the document lead from there to where they led before.
    pub(super) fn write_for(&self, positions: &[[f64; 3]], path: &Path, out: &mut dyn Write) -> Result<(), WriteError> {
        let is_binary = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb"));
        let container = match &self.document {
            // A file may have a name that does not tell what it is, and keep it.
            Document::Gltf(document) if path.file_name() == self.path.file_name() => document.container(),
            _ if is_binary => gltf::Container::Binary,
            _ => gltf::Container::Text,
        };
        let folder = |path: &Path| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            fs::canonicalize(folder.unwrap_or_else(|| Path::new("."))).ok()
        };
        let same_folder = folder(path).is_some_and(|there| folder(&self.path) == Some(there));
        self.write_in(positions, container, same_folder, out)
    }

    fn write_in(
        &self,
        positions: &[[f64; 3]],
        container: gltf::Container,
        same_folder: bool,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        if positions.len() != self.positions.len() {
            return Err(WriteError::Length { given: positions.len(), expected: self.positions.len() });
        }
        match &self.document {
            Document::Obj(document) => Ok(document.write(&self.positions, positions, out)?),
            Document::Ply(document) => document.write(&self.positions, positions, out),
            Document::Gltf(document) => document.write(&self.positions, positions, container, same_folder, out),
        }
    }

    /// The lines of an OBJ file.
    pub(super) fn obj_document(&self) -> Option<&obj::ObjDocument> {
        match &self.document {
            Document::Obj(document) => Some(document),
            Document::Ply(_) | Document::Gltf(_) => None,
        }
    }
}

/// Whether a triangle of texture coordinates is not a point or a line.
fn has_area([a, b, c]: [[f64; 2]; 3]) -> bool {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    area.abs() > 0.0
}

/// Several files in one world.
#[derive(Clone, Debug)]
pub struct World {
    /// The mesh of all files together. It has texture coordinates if any file has them; those of the faces of other files are a single
    /// point, which stands for none.
    pub description: MeshDescription,
    /// Positions in metres, `num_vertices x 3`.
    pub positions: Vec<[f64; 3]>,
    /// The vertices of each file.
    pub file_vertices: Vec<Range<usize>>,
    /// The faces of each file.
    pub file_faces: Vec<Range<usize>>,
}

/// Puts files into one world: vertices, faces and texture coordinates one file after the other.
///
/// # Errors
/// [`ReadErrorKind::Malformed`], if there are more vertices together than indices can name.
pub fn concatenate(files: &[MeshFile]) -> Result<World, ReadErrorKind> {
    let mut world = World {
        description: MeshDescription::default(),
        positions: Vec::new(),
        file_vertices: Vec::with_capacity(files.len()),
        file_faces: Vec::with_capacity(files.len()),
    };
    let with_uvs = files.iter().any(|file| file.uv_faces.is_some());
    let mut uvs = Uvs::default();
    let faces = &mut world.description.faces;
    for file in files {
        let (first_vertex, first_face) = (world.positions.len(), faces.len());
        let too_many = || ReadErrorKind::Malformed("the files have more vertices than 32-bit indices can name".into());
        let last = u32::try_from(first_vertex + file.positions.len()).map_err(|_| too_many())?;
        let vertex_offset = last - u32::try_from(file.positions.len()).map_err(|_| too_many())?;
        world.positions.extend_from_slice(&file.positions);
        faces.extend(file.faces.iter().map(|face| face.map(|vertex| vertex + vertex_offset)));
        if with_uvs {
            let uv_offset = u32::try_from(uvs.coordinates.len()).map_err(|_| too_many())?;
            u32::try_from(uvs.coordinates.len() + file.uv_coordinates.len() + 1).map_err(|_| too_many())?;
            if let Some(uv_faces) = &file.uv_faces {
                uvs.coordinates.extend_from_slice(&file.uv_coordinates);
                uvs.corners.extend(uv_faces.iter().map(|face| face.map(|uv| uv + uv_offset)));
            } else {
                uvs.coordinates.push([0.0; 2]);
                uvs.corners.extend(file.faces.iter().map(|_| [uv_offset; 3]));
            }
        }
        world.file_vertices.push(first_vertex..world.positions.len());
        world.file_faces.push(first_face..faces.len());
    }
    world.description.num_vertices = world.positions.len();
    world.description.uvs = with_uvs.then_some(uvs);
    Ok(world)
}
