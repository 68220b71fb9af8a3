//! What the subcommands on files share: files as one world, and what can be wrong with them.

use std::{
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
    fs,
    path::{Path, PathBuf},
};

use serde::{Serialize, Serializer};
use thiserror::Error;

use crate::{
    analysis::Analysis,
    frame::{Frame, FrameError},
    io::{MeshFile, ReadError, ReadErrorKind, World, concatenate, read_mesh},
    mesh::{Mesh, MeshError, VertexId},
    paths::PairType,
};

/// Why files are no world that can be analysed.
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
    /// A coordinate is beyond the range of exact arithmetic.
    #[error("{}: {source}", path.display())]
    Frame {
        /// The file.
        path: PathBuf,
        /// What is wrong; vertices counted from 0 in this file.
        source: FrameError,
    },
}

/// Reads all files, in order.
pub(super) fn read_files(paths: &[PathBuf]) -> Result<Vec<MeshFile>, InputError> {
    Ok(paths.iter().map(read_mesh).collect::<Result<_, _>>()?)
}

/// Files in one world, before anything is checked; `paths` are their names in messages.
pub(super) fn join(paths: &[PathBuf], meshes: &[MeshFile]) -> Result<World, InputError> {
    concatenate(meshes).map_err(|source| InputError::World { files: names(paths), source })
}

/// Files in one world, ready to be analysed.
#[derive(Clone, Debug)]
pub(super) struct Input {
    pub(super) mesh: Mesh,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) frame: Frame,
}

impl Input {
    /// Validates a world; vertices in messages are those of a file.
    pub(super) fn new(paths: &[PathBuf], world: World) -> Result<Self, InputError> {
        let World { description, positions, file_vertices, .. } = world;
        let mesh = Mesh::new(description).map_err(|source| InputError::Mesh { files: names(paths), source })?;
        let frame = Frame::new(&mesh, &positions).map_err(|source| {
            let FrameError::Coordinate { vertex, axis, value } = source else {
                return InputError::Frame { path: names(paths).into(), source };
            };
            let (path, range) = paths
                .iter()
                .zip(&file_vertices)
                .find(|(_, range)| range.contains(&vertex))
                .map_or((PathBuf::new(), 0..0), |(path, range)| (path.clone(), range.clone()));
            InputError::Frame { path, source: FrameError::Coordinate { vertex: vertex - range.start, axis, value } }
        })?;
        Ok(Self { mesh, positions, frame })
    }

    /// Whether a vertex stays where it is.
    pub(super) fn is_pinned(&self, vertex: usize) -> bool {
        u32::try_from(vertex).is_ok_and(|vertex| self.mesh.is_pinned(VertexId(vertex)))
    }
}

fn names(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Number of path pairs by type, types without any left out.
pub(super) fn count_path_pairs(analysis: &Analysis) -> BTreeMap<PairType, usize> {
    let mut counts = BTreeMap::new();
    for pair in &analysis.paths.pairs {
        *counts.entry(pair.pair_type).or_default() += 1;
    }
    counts
}

/// The name of a type or method, as in JSON.
pub(super) fn name_of(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
}

/// Serialises paths as text. Names that are none are shown as well as they can be: JSON has no bytes.
pub(super) fn paths_as_text<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.to_string_lossy()))
}

/// Whether two names, however spelt or linked, are one existing file.
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(a), Ok(b)) => a.dev() == b.dev() && a.ino() == b.ino(),
        _ => false,
    }
}

/// `1 face`, `2 faces`.
pub(super) struct Counted(pub(super) usize, pub(super) &'static str);

impl Display for Counted {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self(count, noun) = self;
        let plural = if *count == 1 { "" } else { "s" };
        write!(f, "{count} {noun}{plural}")
    }
}
