//! A mesh under other names of vertices and faces.

use crate::mesh::{FaceId, Mesh, MeshDescription, Uvs, VertexId};

/// A mesh under other names, without bodies and layers: of each new vertex `order` has the old one. Faces have the
/// order of the new names of their corners, of which the least comes first. Which way round a face runs stays.
///
/// Cost: O(n log n).
pub(super) fn renamed(mesh: &Mesh, order: &[VertexId]) -> MeshDescription {
    let mut names = vec![0; order.len()];
    (0u32..).zip(order).for_each(|(name, old)| names[old.index()] = name);
    let mut faces: Vec<([u32; 3], FaceId, usize)> = mesh
        .face_ids()
        .map(|face| {
            let corners = mesh.face(face).map(|corner| names[corner.index()]);
            let first = (0..3).min_by_key(|&corner| corners[corner]).unwrap_or(0);
            (turned(corners, first), face, first)
        })
        .collect();
    faces.sort_unstable();
    let uvs = mesh.uvs().map(|uvs| Uvs {
        coordinates: uvs.coordinates.clone(),
        corners: faces.iter().map(|&(_, face, first)| turned(uvs.corners[face.index()], first)).collect(),
    });
    MeshDescription {
        num_vertices: order.len(),
        faces: faces.into_iter().map(|(corners, ..)| corners).collect(),
        uvs,
        rest_positions: mesh.rest_positions().map(|rest| order.iter().map(|old| rest[old.index()]).collect()),
        masses_kg: mesh.masses_kg().map(|masses| order.iter().map(|old| masses[old.index()]).collect()),
        pins: (0u32..).zip(order).filter(|(_, old)| mesh.is_pinned(**old)).map(|(name, _)| name).collect(),
        ..Default::default()
    }
}

/// The corners of a face from one of them on.
fn turned(corners: [u32; 3], first: usize) -> [u32; 3] {
    [0, 1, 2].map(|corner| corners[(first + corner) % 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn renamed_mesh_keeps_the_data_of_its_elements_and_the_sense_of_its_faces() {
        let corners = vec![[0, 1, 2], [0, 2, 3]];
        let uvs = Uvs { coordinates: vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]], corners: corners.clone() };
        let mesh = Mesh::new(MeshDescription {
            num_vertices: 4,
            faces: corners,
            uvs: Some(uvs),
            rest_positions: Some(vec![[0.; 3], [1.; 3], [2.; 3], [3.; 3]]),
            masses_kg: Some(vec![0., 1., 2., 3.]),
            pins: vec![1],
            ..Default::default()
        });
        let renamed = renamed(&mesh.unwrap(), &[3, 2, 1, 0].map(VertexId));
        // Old names 0 to 3 are new names 3 to 0.
        assert_eq!(renamed.faces, [[0, 3, 1], [1, 3, 2]]);
        assert_eq!(renamed.uvs.unwrap().corners, [[3, 0, 2], [2, 0, 1]]);
        assert_eq!(renamed.rest_positions.unwrap(), [[3.; 3], [2.; 3], [1.; 3], [0.; 3]]);
        assert_eq!(renamed.masses_kg.unwrap(), [3., 2., 1., 0.]);
        assert_eq!(renamed.pins, [2]);
    }
}
