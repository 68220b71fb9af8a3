//! What all frames of a cache have in common.

use super::error::CacheErrorKind;
use crate::{formats::polygon::Polygons, mesh_file::MeshFile};

/// The vertices and polygons of the files to which a cache belongs, one file after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Topology {
    pub(super) num_vertices: usize,
    num_polygons: usize,
    /// The first vertex of each file, and its polygons.
    files: Vec<(usize, Polygons)>,
}

impl Topology {
    pub(super) fn of(files: &[MeshFile]) -> Self {
        let mut topology = Self::default();
        for file in files {
            topology.files.push((topology.num_vertices, file.polygons().clone()));
            topology.num_vertices += file.positions().len();
            topology.num_polygons += file.polygons().len();
        }
        topology
    }

    /// Checks that a mesh has these vertices and polygons.
    pub(super) fn check(&self, file: &MeshFile) -> Result<(), CacheErrorKind> {
        let (given, expected) = (file.positions().len(), self.num_vertices);
        if given != expected {
            return Err(CacheErrorKind::NumVertices { given: given as u64, expected });
        }
        let (given, expected) = (file.polygons().len(), self.num_polygons);
        if given != expected {
            return Err(CacheErrorKind::NumFaces { given, expected });
        }
        let own = self.files.iter().flat_map(|(first, polygons)| {
            (0..polygons.len()).map(move |polygon| polygons.corners(polygon).iter().map(move |&v| first + v as usize))
        });
        for (polygon, own) in own.enumerate() {
            if !own.eq(file.polygons().corners(polygon).iter().map(|&vertex| vertex as usize)) {
                return Err(CacheErrorKind::OtherFace(polygon));
            }
        }
        Ok(())
    }
}
