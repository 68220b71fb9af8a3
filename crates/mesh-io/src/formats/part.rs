//! The named parts of a file.

use std::{
    fmt::{self, Display, Formatter},
    ops::Range,
    sync::Arc,
};

use crate::printable::Printable;

/// A run of faces or vertices under one name: of an object and a group in OBJ, of a node and a mesh in glTF, of a solid
/// in STL. PLY has no names.
///
/// Its [`Display`] is for messages: `object "shirt", group "left sleeve"`, control characters escaped.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// The outer name: of the object (`o`) in OBJ, of the node in glTF, of the solid in STL.
    pub outer: Option<PartName>,
    /// The inner name: of the group (`g`) in OBJ, of the mesh in glTF.
    pub inner: Option<PartName>,
    /// The triangles that stand under the names, as indices into [`MeshFile::faces`](crate::MeshFile::faces).
    pub faces: Range<usize>,
    /// The vertices that stand under the names, from 0. In OBJ they may be empty, as vertices often stand before all
    /// names; [`MeshFile::vertex_parts`](crate::MeshFile::vertex_parts) asks the faces too.
    pub vertices: Range<usize>,
}

/// The name of a part and what bears it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartName {
    /// `object`, `group`, `node`, `mesh` or `solid`.
    pub kind: &'static str,
    /// The name as the file has it, with replacement characters where it is not UTF-8; shared by all parts that have
    /// it.
    pub name: Arc<str>,
}

impl Display for Part {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for PartName { kind, name } in self.outer.iter().chain(&self.inner) {
            write!(formatter, "{separator}{kind} \"{}\"", Printable(name))?;
            separator = ", ";
        }
        Ok(())
    }
}

/// Collects parts while a file is read. Their `faces` count polygons until [`finish`](Self::finish).
#[derive(Clone, Debug, Default)]
pub(crate) struct PartBuilder {
    parts: Vec<Part>,
    open: Part,
}

impl PartBuilder {
    /// Names what follows; `polygon` and `vertex` are the numbers of the next ones.
    pub(crate) fn rename(&mut self, polygon: usize, vertex: usize, change: impl FnOnce(&mut Part)) {
        self.close(polygon, vertex);
        change(&mut self.open);
    }

    fn close(&mut self, polygon: usize, vertex: usize) {
        let (faces, vertices) = (self.open.faces.start..polygon, self.open.vertices.start..vertex);
        let is_named = self.open.outer.is_some() || self.open.inner.is_some();
        if is_named && !(faces.is_empty() && vertices.is_empty()) {
            self.parts.push(Part { faces, vertices, ..self.open.clone() });
        }
        (self.open.faces.start, self.open.vertices.start) = (polygon, vertex);
    }

    /// All parts in the order of the file.
    pub(crate) fn finish(mut self, num_polygons: usize, num_vertices: usize) -> Vec<Part> {
        self.close(num_polygons, num_vertices);
        self.parts
    }
}
