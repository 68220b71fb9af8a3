//! Distances to keep, by position-based dynamics.

use nalgebra::Vector3;
use untangle::mesh::{FaceId, Mesh, Uvs, VertexId};

const BENDING: f64 = 0.3;

/// Two vertices with their distance at rest in metres, and the part of a difference that one iteration takes away.
pub(crate) struct Spring {
    pub(crate) ends: [usize; 2],
    pub(crate) length: f64,
    pub(crate) stiffness: f64,
}

/// One iteration over all springs, in order.
pub(crate) fn project(springs: &[Spring], positions: &mut [[f64; 3]]) {
    for &Spring { ends: [a, b], length: wanted, stiffness } in springs {
        let (pa, pb) = (Vector3::from(positions[a]), Vector3::from(positions[b]));
        let way = pb - pa;
        let length = way.norm();
        if length > 0.0 {
            let move_by = way * (0.5 * stiffness * (length - wanted) / length);
            positions[a] = (pa + move_by).into();
            positions[b] = (pb - move_by).into();
        }
    }
}

/// Edges, and the pairs of vertices opposite each inner edge, with their lengths in UV or in the world.
pub(crate) fn springs(mesh: &Mesh, positions: &[[f64; 3]], flat: Option<&Uvs>) -> Vec<Spring> {
    let place = |face: FaceId, vertex: VertexId| -> Vector3<f64> {
        let Some(uvs) = flat else { return Vector3::from(positions[vertex.index()]) };
        let corner = mesh.face(face).iter().position(|&v| v == vertex).unwrap_or(0);
        let [u, v] = uvs.coordinates[uvs.corners[face.index()][corner] as usize];
        Vector3::new(u, v, 0.0)
    };
    let mut springs = Vec::new();
    for edge in mesh.edge_ids() {
        let [a, b] = mesh.edge(edge);
        let faces = mesh.edge_faces(edge);
        let length = (place(faces[0], b) - place(faces[0], a)).norm();
        springs.push(Spring { ends: [a.index(), b.index()], length, stiffness: 1.0 });
        if let &[one, other] = faces {
            let opposite = |face| mesh.face(face).into_iter().find(|&vertex| vertex != a && vertex != b).unwrap_or(a);
            let (c, d) = (opposite(one), opposite(other));
            let gap = if flat.is_none() {
                (place(one, c) - place(other, d)).norm()
            } else {
                let [one, other] = [(one, c), (other, d)].map(|(face, vertex)| [a, b, vertex].map(|v| place(face, v)));
                unfolded_gap(one, other)
            };
            springs.push(Spring { ends: [c.index(), d.index()], length: gap, stiffness: BENDING });
        }
    }
    springs
}

/// Distance of the tips of two triangles `a, b, tip` that lie in one plane on either side of their common edge.
fn unfolded_gap(one: [Vector3<f64>; 3], other: [Vector3<f64>; 3]) -> f64 {
    let across = |[p, q, r]: [Vector3<f64>; 3]| {
        let along = (q - p).normalize();
        ((r - p).dot(&along), (r - p - along * (r - p).dot(&along)).norm())
    };
    let ((xc, yc), (xd, yd)) = (across(one), across(other));
    (xc - xd).hypot(yc + yd)
}

/// Length of each edge, at least the smallest positive number.
pub(crate) fn edge_lengths(mesh: &Mesh, positions: &[[f64; 3]]) -> Vec<f64> {
    mesh.edge_ids()
        .map(|edge| {
            let [a, b] = mesh.edge(edge).map(|vertex| Vector3::from(positions[vertex.index()]));
            (b - a).norm().max(f64::MIN_POSITIVE)
        })
        .collect()
}
