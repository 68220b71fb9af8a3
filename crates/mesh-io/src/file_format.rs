//! The formats, and what tells them.

use std::path::Path;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Wavefront OBJ.
    Obj,
    /// PLY, ascii or binary.
    Ply,
    /// glTF 2.0, as `.gltf` with its buffers or as `.glb`.
    Gltf,
    /// STL, ascii or binary.
    Stl,
    /// USD, as text, binary or an archive, whose meshes [`VertexCache::open_usd`](crate::VertexCache::open_usd) reads.
    Usd,
}

impl FileFormat {
    /// The format that the extension of a file name stands for.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "gltf" | "glb" => Some(Self::Gltf),
            "stl" => Some(Self::Stl),
            "usd" | "usda" | "usdc" | "usdz" => Some(Self::Usd),
            _ => None,
        }
    }

    /// The format that the first bytes of a file show. OBJ and STL have no such mark, nor has glTF as text.
    pub(crate) fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r\n") {
            Some(Self::Ply)
        } else if bytes.starts_with(b"glTF") {
            Some(Self::Gltf)
        } else {
            None
        }
    }
}
