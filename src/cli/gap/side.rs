//! A primitive, or some vertices, as a reader of the files finds them.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use crate::cli::owners::{OwnedVertex, Owners};

/// A primitive as a reader of the files finds it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Side {
    /// The file.
    pub file: String,
    /// The object or group of its first vertex, if that has a name.
    pub part: Option<String>,
    /// Its vertices, counted from 0 over all files; of a welded one the lowest.
    pub vertices: Vec<u32>,
    /// The same counted from 0 in the file.
    pub vertices_in_file: Vec<usize>,
}

impl Side {
    pub(super) fn new(vertices: &[u32], owners: &Owners<'_>) -> Self {
        let mut side = Self { vertices: vertices.to_vec(), ..Self::default() };
        for OwnedVertex { file, vertex_in_file, part } in
            owners.of_vertices(vertices.iter().copied()).into_iter().flatten()
        {
            if side.vertices_in_file.is_empty() {
                (side.file, side.part) = (file, part);
            }
            side.vertices_in_file.push(vertex_in_file);
        }
        side
    }
}

impl Display for Side {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let kind = ["vertex", "edge", "face"][self.vertices_in_file.len().clamp(1, 3) - 1];
        let vertices: Vec<String> = self.vertices_in_file.iter().map(ToString::to_string).collect();
        write!(f, "{kind} {} of {}", vertices.join(" "), self.file)?;
        self.part.as_ref().map_or(Ok(()), |part| write!(f, ", {part}"))
    }
}
