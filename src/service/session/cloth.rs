//! The cloth of a session: its mesh, and where the host's vertices are in it. They are the mesh's own, unless the host
//! asked for those in one place to be one.

use std::sync::Arc;

use untangle::{
    labels::VertexLabel,
    mesh::{Mesh, MeshDescription, MeshError, VertexId},
    sides::Layers,
    weld::{Weld, WeldError},
};

/// The mesh of a session, and the host's vertices.
#[derive(Debug)]
pub struct Cloth {
    mesh: Arc<Mesh>,
    seams: Option<Seams>,
}

/// Vertices of the host that are one in the mesh.
#[derive(Debug)]
struct Seams {
    weld: Weld,
    /// The part of its welded vertex' mass that a vertex of the host has.
    shares: Vec<f64>,
}

impl Cloth {
    /// A cloth whose vertices are those of the host.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn new(description: MeshDescription) -> Result<Self, MeshError> {
        Ok(Self { mesh: decided(Mesh::new(description)?), seams: None })
    }

    /// A cloth in which vertices with exactly one place in `positions`, in metres, are one along seams.
    ///
    /// # Errors
    /// [`WeldError`].
    pub fn welded(description: &MeshDescription, positions: &[[f64; 3]]) -> Result<Self, WeldError> {
        let weld = Weld::find(description, positions, &[], 0.0)?;
        let mesh = Mesh::new(weld.describe(description))?;
        let share = |vertex: u32| {
            let copies = weld.copies(weld.of(vertex));
            let mass = |&copy: &u32| description.masses_kg.as_ref().map_or(1.0, |masses| masses[copy as usize]);
            let sum: f64 = copies.iter().map(mass).sum();
            #[expect(clippy::cast_precision_loss, reason = "a count of vertices in one place")]
            let equal = 1.0 / copies.len() as f64;
            if sum > 0.0 { mass(&vertex) / sum } else { equal }
        };
        let shares = (0..u32::try_from(weld.num_vertices()).unwrap_or(u32::MAX)).map(share).collect();
        Ok(Self { mesh: decided(mesh), seams: Some(Seams { weld, shares }) })
    }

    /// The mesh, of welded vertices.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// How vertices of the host are welded, if that was asked for.
    #[must_use]
    pub fn weld(&self) -> Option<&Weld> {
        self.seams.as_ref().map(|seams| &seams.weld)
    }

    /// Number of vertices of the host.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        self.weld().map_or(self.mesh.num_vertices(), Weld::num_vertices)
    }

    /// Number of vertices of the host that belong to bodies.
    pub(crate) fn num_body_vertices(&self) -> usize {
        (0..self.num_vertices()).filter(|&vertex| self.mesh.is_body(self.mesh_vertex(vertex))).count()
    }

    /// The vertex of the mesh that a vertex of the host is.
    pub(crate) fn mesh_vertex(&self, host_vertex: usize) -> VertexId {
        let vertex = VertexId::from_index(host_vertex);
        self.weld().map_or(vertex, |weld| weld.of(vertex.0))
    }

    /// The vertex of the host that a vertex of the mesh is; of several the lowest.
    pub(crate) fn host_vertex(&self, vertex: VertexId) -> u32 {
        self.weld().map_or(vertex.0, |weld| weld.first(vertex))
    }

    /// The part of its force that a vertex of the host gets, so that all that are one accelerate alike.
    pub(crate) fn share(&self, host_vertex: usize) -> f64 {
        self.seams.as_ref().map_or(1.0, |seams| seams.shares[host_vertex])
    }

    /// The host's vertices that some vertices of the mesh are, ascending; `host` is memory for welded ones.
    pub(crate) fn host_vertices<'a>(&self, vertices: &'a [VertexId], host: &'a mut Vec<VertexId>) -> &'a [VertexId] {
        let Some(weld) = self.weld() else { return vertices };
        host.clear();
        host.extend(vertices.iter().flat_map(|&vertex| weld.copies(vertex)).map(|&copy| VertexId(copy)));
        host.sort_unstable();
        host
    }

    /// Labels of vertices of the mesh as those of the host's vertices, ascending by vertex and label; `host` is memory
    /// for those of welded ones.
    pub(crate) fn host_labels<'a>(
        &self,
        labels: &'a [VertexLabel],
        host: &'a mut Vec<VertexLabel>,
    ) -> &'a [VertexLabel] {
        let Some(weld) = self.weld() else { return labels };
        host.clear();
        host.extend(labels.iter().flat_map(|label| {
            weld.copies(label.vertex).iter().map(|&copy| VertexLabel { vertex: VertexId(copy), ..*label })
        }));
        host.sort_unstable_by_key(|label| (label.vertex, label.label));
        host
    }
}

/// The mesh of a session. What is outwards of its layers is decided here or in each frame by itself: no frame hangs on
/// another one.
fn decided(mesh: Mesh) -> Arc<Mesh> {
    Arc::new(Layers::decide_at_rest(mesh))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloth_that_is_welded_shares_forces_by_mass_and_lists_all_vertices_in_one_place() {
        let rest = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0; 3]];
        let description = MeshDescription {
            num_vertices: 6,
            faces: vec![[0, 1, 2], [3, 5, 4]],
            masses_kg: Some(vec![1.0, 1.0, 0.0, 3.0, 0.0, 1.0]),
            ..MeshDescription::default()
        };
        let cloth = Cloth::welded(&description, &rest).unwrap();
        assert_eq!((cloth.num_vertices(), cloth.mesh().num_vertices()), (6, 4));
        assert_eq!([0, 1, 2, 3, 4, 5].map(|vertex| cloth.mesh_vertex(vertex).0), [0, 1, 2, 1, 2, 3]);
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|vertex| (4.0 * cloth.share(vertex)).to_string()),
            ["4", "1", "2", "3", "2", "4"]
        );
        let mut host = Vec::new();
        let found = cloth.host_vertices(&[VertexId(1), VertexId(2)], &mut host);
        assert_eq!(found, [1, 2, 3, 4].map(VertexId));
        let mut labels = Vec::new();
        let label = |vertex, label| VertexLabel { vertex: VertexId(vertex), label };
        let own = [label(1, 9), label(1, 13), label(2, 9)];
        let found = cloth.host_labels(&own, &mut labels);
        let expected = [label(1, 9), label(1, 13), label(2, 9), label(3, 9), label(3, 13), label(4, 9)];
        assert_eq!(found, expected);
    }
}
