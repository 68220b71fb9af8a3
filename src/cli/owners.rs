//! Who a vertex or a face of the world belongs to: its file, and the object or group in it.

use untangled_mesh_io::{MeshFile, Printable};

/// The files of a world, one after the other.
pub(super) struct Owners<'a> {
    files: Vec<&'a MeshFile>,
}

/// A vertex by its owner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OwnedVertex {
    pub(super) file: String,
    pub(super) vertex_in_file: usize,
    /// `object "shirt", group "sleeve"`, where it has a name.
    pub(super) part: Option<String>,
}

impl<'a> Owners<'a> {
    pub(super) fn new(files: impl IntoIterator<Item = &'a MeshFile>) -> Self {
        Self { files: files.into_iter().collect() }
    }

    /// The owners of vertices, in the order asked for.
    pub(super) fn of_vertices(&self, vertices: impl Iterator<Item = u32>) -> Vec<Option<OwnedVertex>> {
        let parts: Vec<_> = self.files.iter().map(|file| file.vertex_parts()).collect();
        let owner = |vertex: u32| {
            let mut index = vertex as usize;
            for (file, parts) in self.files.iter().zip(&parts) {
                if let Some(part) = parts.get(index) {
                    let part = part.map(ToString::to_string);
                    return Some(OwnedVertex { file: name_of(file), vertex_in_file: index, part });
                }
                index -= parts.len();
            }
            None
        };
        vertices.map(owner).collect()
    }

    /// The name of the owner of a face: its file, where there are several, and its part. Nothing if there is no name.
    pub(super) fn of_face(&self, face: u32) -> Option<String> {
        let mut index = face as usize;
        for &file in &self.files {
            if index < file.faces().len() {
                let part = file.part_of_face(index).map(ToString::to_string);
                let own = (self.files.len() > 1).then(|| name_of(file));
                let words: Vec<String> = own.into_iter().chain(part).collect();
                return (!words.is_empty()).then(|| words.join(", "));
            }
            index -= file.faces().len();
        }
        None
    }
}

fn name_of(file: &MeshFile) -> String {
    Printable(&file.path().display().to_string()).to_string()
}
