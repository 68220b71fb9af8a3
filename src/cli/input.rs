//! Mesh files as one world, what can be wrong with them, and their analysis.

use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

use thiserror::Error;

use untangle::{
    analysis::{Analyser, Analysis},
    frame::{Frame, FrameError},
    intersect::SearchEnd,
    mesh::{Mesh, MeshError, VertexId},
    settings::Settings,
    sides::Layers,
    stage::StageObserver,
    weld::{Weld, WeldError},
};
use untangled_mesh_io::{FileFormat, MeshFile, ReadError, ReadErrorKind, World, concatenate, read_mesh};

use super::weld::WeldArg;

/// Why files can't be analysed.
#[derive(Debug, Error)]
pub enum InputError {
    /// A file can't be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The files together can't be put into one world.
    #[error("{files}: {source}")]
    World {
        /// The files.
        files: String,
        /// What is wrong.
        source: ReadErrorKind,
    },
    /// What was read is no mesh that can be analysed.
    #[error("{files}: {source}")]
    Mesh {
        /// The files.
        files: String,
        /// What is wrong.
        source: MeshError,
    },
    /// What was read can't be welded.
    #[error("{files}: {source}")]
    Weld {
        /// The files.
        files: String,
        /// What is wrong.
        source: WeldError,
    },
    /// A coordinate is beyond the range of exact arithmetic.
    #[error("{}{}: {source}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Frame {
        /// The file.
        path: PathBuf,
        /// Line at fault, counted from 1, in a text format.
        line: Option<usize>,
        /// What is wrong; vertices of this file, counted as its format does: from 1 in OBJ, from 0 elsewhere.
        source: FrameError,
    },
    /// More intersects than was asked for.
    #[error("{files}: more than {limit} pairs of triangles intersect; a larger --max-face-pairs takes more memory")]
    TooManyFacePairs {
        /// The files.
        files: String,
        /// Most pairs.
        limit: u64,
    },
}

/// Reads all files, in order.
pub(super) fn read_files(paths: &[PathBuf]) -> Result<Vec<MeshFile>, InputError> {
    Ok(paths.iter().map(read_mesh).collect::<Result<_, _>>()?)
}

/// Puts files into one world, not validated yet; `paths` are their names in messages.
pub(super) fn join(paths: &[PathBuf], meshes: &[MeshFile]) -> Result<World, InputError> {
    concatenate(meshes).map_err(|source| InputError::World { files: names(paths), source })
}

/// A validated world, welded.
#[derive(Clone, Debug)]
pub(super) struct Input {
    /// Which vertices of the files are one vertex of the mesh.
    pub(super) weld: Weld,
    /// The welded mesh.
    pub(super) mesh: Mesh,
    /// Positions of the vertices of the files in metres, `num_vertices x 3`.
    pub(super) positions: Vec<[f64; 3]>,
    /// Positions of the vertices of the mesh.
    pub(super) frame: Frame,
}

impl Input {
    /// Welds and validates the world of `files`.
    pub(super) fn new(files: &[MeshFile], world: World, weld: WeldArg) -> Result<Self, InputError> {
        let weld = weld
            .find(&world.description, &world.positions, &world.file_vertices)
            .map_err(|source| InputError::Weld { files: names_of(files), source })?;
        Self::with_weld(files, world, weld)
    }

    /// Validates the world of `files`, with a weld that is known.
    pub(super) fn with_weld(files: &[MeshFile], world: World, weld: Weld) -> Result<Self, InputError> {
        let World { description, positions, file_vertices, .. } = world;
        let mesh = Mesh::new(weld.describe(&description))
            .map_err(|source| InputError::Mesh { files: names_of(files), source })?;
        let frame = Frame::new(&mesh, &weld.gather(&positions))
            .map_err(|source| locate(source, &weld, files, &file_vertices))?;
        Ok(Self { weld, mesh, positions, frame })
    }

    /// What is outwards of layers is decided by this state, for all that follow from it.
    pub(super) fn decided(self) -> Self {
        Self { mesh: Layers::decide(self.mesh, &self.frame), ..self }
    }

    /// What is outwards of layers is what it is in another state.
    pub(super) fn with_outwards(self, outwards: Option<&[bool]>) -> Self {
        Self { mesh: self.mesh.with_outwards(outwards), ..self }
    }

    /// Coordinates of vertices of the mesh that are not zero, but so small that they count as zero.
    pub(super) fn num_zeroed_coordinates(&self) -> usize {
        let given = self.weld.gather(&self.positions);
        let pairs = given.iter().zip(self.frame.positions());
        let is_zeroed = |(given, seen): (&f64, &f64)| given.abs() > 0.0 && seen.abs() <= 0.0;
        pairs.map(|(given, seen)| given.iter().zip(seen.coords.iter()).filter(|&pair| is_zeroed(pair)).count()).sum()
    }

    /// Whether a vertex of the files is pinned.
    pub(super) fn is_pinned(&self, vertex: usize) -> bool {
        u32::try_from(vertex).is_ok_and(|vertex| self.mesh.is_pinned(self.weld.of(vertex)))
    }
}

/// Adds the file and the line to the error of a position.
fn locate(source: FrameError, weld: &Weld, files: &[MeshFile], file_vertices: &[Range<usize>]) -> InputError {
    let FrameError::Coordinate { vertex, axis, value } = source else {
        unreachable!("files have one position for each vertex: {source}");
    };
    let vertex = weld.first(VertexId::from_index(vertex)) as usize;
    let owner = files.iter().zip(file_vertices).find(|(_, range)| range.contains(&vertex));
    owner.map_or_else(
        || unreachable!("vertex {vertex} belongs to no file"),
        |(file, range)| {
            let vertex = vertex - range.start;
            let line = file.line_of_vertex(vertex);
            let vertex = vertex + usize::from(file.format() == FileFormat::Obj);
            let source = FrameError::Coordinate { vertex, axis, value };
            InputError::Frame { path: file.path().to_path_buf(), line, source }
        },
    )
}

fn names_of(files: &[MeshFile]) -> String {
    names(&files.iter().map(|file| file.path().to_path_buf()).collect::<Vec<_>>())
}

pub(super) fn names(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Whether two paths, through any spelling or link, lead to the same existing file.
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(a), Ok(b)) => a.dev() == b.dev() && a.ino() == b.ino(),
        _ => false,
    }
}

/// Most pairs of triangles that may intersect, where the user gives no limit: they take about three gigabytes, up to
/// eight where each is a path of its own.
pub(super) const MAX_FACE_PAIRS: u64 = 4_000_000;

/// Analyses files, unless more than `max_face_pairs` of their triangles intersect. However many boxes overlap, there is
/// no limit of time: a person or a script is there to end it.
pub(super) fn analyse_within(
    files: &[PathBuf],
    Input { mesh, frame, .. }: &Input,
    max_face_pairs: u64,
    observer: &mut dyn StageObserver,
) -> Result<Analysis, InputError> {
    let (max_face_pairs, max_tested_pairs) = (Some(max_face_pairs), Some(u64::MAX));
    let settings = Settings { max_face_pairs, max_tested_pairs, ..Settings::default() };
    let mut analyser = Analyser::default();
    analyser.analyse(mesh, frame, &settings, observer);
    match analyser.search_end() {
        SearchEnd::Complete => Ok(analyser.into_last()),
        SearchEnd::TooManyPairs | SearchEnd::OutOfTime => {
            Err(InputError::TooManyFacePairs { files: names(files), limit: max_face_pairs.unwrap_or_default() })
        }
    }
}
