//! A coarser mesh, and a state of it carried over to the finer one.

use nalgebra::Point3;

use super::{collapse::Collapser, removed::RemovedVertex};
use crate::mesh::{Mesh, MeshDescription, VertexId};

/// A coarser mesh has one vertex for so many of the finer one.
const VERTICES_PER_VERTEX: usize = 2;
/// Meshes with no more vertices are coarse.
const COARSE: usize = 200;

/// A coarser mesh of which the vertices are some of those of a finer one.
pub(in crate::relax) struct CoarserMesh {
    pub(in crate::relax) mesh: Mesh,
    /// In metres.
    pub(in crate::relax) positions: Vec<[f64; 3]>,
    /// For each of its vertices that of the finer mesh.
    kept: Vec<u32>,
    removed: Vec<RemovedVertex>,
}

impl CoarserMesh {
    /// Nothing where the mesh is coarse already, or can't get much coarser. It has no bodies and no layers.
    ///
    /// Cost: O(n log n).
    pub(in crate::relax) fn of(mesh: &Mesh, positions: &[Point3<f64>]) -> Option<Self> {
        let num_used = mesh.vertex_ids().filter(|vertex| !mesh.vertex_faces(*vertex).is_empty()).count();
        if num_used <= COARSE {
            return None;
        }
        let mut collapser = Collapser::new(mesh, positions);
        let wanted = num_used - num_used / VERTICES_PER_VERTEX;
        let removed = collapser.remove(wanted);
        if 2 * removed.len() < wanted {
            return None;
        }
        let mut is_removed = vec![false; positions.len()];
        removed.iter().for_each(|removed| is_removed[removed.vertex as usize] = true);
        let is_kept = |vertex: &VertexId| !is_removed[vertex.index()];
        let kept: Vec<u32> = mesh.vertex_ids().filter(is_kept).map(|vertex| vertex.0).collect();
        let mut names = vec![0; positions.len()];
        (0u32..).zip(&kept).for_each(|(name, &vertex)| names[vertex as usize] = name);
        let pinned = (0u32..).zip(&kept).filter(|(_, vertex)| mesh.is_pinned(VertexId(**vertex)));
        let description = MeshDescription {
            num_vertices: kept.len(),
            faces: collapser.faces().map(|face| face.map(|corner| names[corner as usize])).collect(),
            pins: pinned.map(|(name, _)| name).collect(),
            ..Default::default()
        };
        let positions = kept.iter().map(|&vertex| positions[vertex as usize].into()).collect();
        Some(Self { mesh: Mesh::new(description).ok()?, positions, kept, removed })
    }

    /// Where the vertices of the finer mesh are in a state of this one. What has not moved round a vertex leaves it
    /// where it is in `input`, to the bit.
    ///
    /// Cost: O(n).
    pub(in crate::relax) fn prolonged(&self, input: &[Point3<f64>], state: &[Point3<f64>]) -> Vec<Point3<f64>> {
        let mut now = input.to_vec();
        self.kept.iter().zip(state).for_each(|(&vertex, &at)| now[vertex as usize] = at);
        // Each lies on what was left when it was removed: those that were removed later are there first.
        for removed in self.removed.iter().rev() {
            let displacement = removed.place(&now) - removed.place(input);
            now[removed.vertex as usize] += displacement;
        }
        now
    }
}
