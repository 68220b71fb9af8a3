//! Islands that must take the same trial: where they took different ones, an edge between them would be overstretched.

use nalgebra::Point3;

use crate::{
    mesh::{Mesh, VertexId},
    relax::{constraints::StrainLimits, energy::Domain, step::islands::Islands},
};

/// A partition of the islands, and of what lies near none of them, into groups.
#[derive(Debug)]
pub(crate) struct Groups {
    /// The group of each island: the lowest island in it.
    labels: Vec<usize>,
}

/// Where the strain limits are checked between islands.
#[derive(Clone, Copy)]
pub(crate) struct Seams<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) domain: &'a Domain,
    pub(crate) islands: &'a Islands,
    pub(crate) limits: &'a StrainLimits,
    /// The state before the step.
    pub(crate) before: &'a [Point3<f64>],
}

impl Groups {
    /// Each of so many islands on its own.
    pub(crate) fn of_single_islands(num_islands: usize) -> Self {
        Self { labels: (0..num_islands).collect() }
    }

    /// The islands of each group, ascending.
    pub(crate) fn members(&self) -> Vec<Vec<usize>> {
        let mut members = vec![Vec::new(); self.labels.len()];
        for (island, &label) in self.labels.iter().enumerate() {
            members[label].push(island);
        }
        members.retain(|group| !group.is_empty());
        members
    }

    /// Joins groups with an edge or a face between them that `after` takes beyond its limit. False if there are none.
    ///
    /// Cost: linear in the vertices of the domain, and in the islands for each pair that is joined.
    pub(crate) fn join_torn(&mut self, seams: &Seams<'_>, after: &[Point3<f64>]) -> bool {
        let Seams { mesh, domain, islands, limits, before } = *seams;
        let mut any = false;
        for &vertex in domain.vertices() {
            let own = self.labels[islands.of(vertex)];
            let neighbours = mesh.vertex_edges(vertex).iter().map(|&edge| mesh.opposite_vertex(edge, vertex));
            let is_other = |&other: &VertexId| self.labels[islands.of(other)] != own;
            let mut others = neighbours.filter(is_other).peekable();
            if others.peek().is_none() || !limits.is_violated(mesh, before, after, vertex) {
                continue;
            }
            let others: Vec<usize> = others.map(|other| islands.of(other)).collect();
            for other in others {
                any |= self.join(islands.of(vertex), other);
            }
        }
        any
    }

    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.labels[a], self.labels[b]);
        let (low, high) = (a.min(b), a.max(b));
        for label in self.labels.iter_mut().filter(|label| **label == high) {
            *label = low;
        }
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        analysis::analyse,
        correspond::samples::{sheet, sheet_faces},
        frame::Frame,
        mesh::MeshDescription,
    };

    #[test]
    fn join_torn_joins_islands_with_an_overstretched_edge_between_them_and_no_others() {
        // A sheet with three dents through another.
        let (_, flat) = sheet(24, 6, 1.0);
        let dent = |x: f64, y: f64| if (y - 3.0).abs() < 0.1 && (x % 8.0 - 4.0).abs() < 0.1 { -1.0 } else { 1.0 };
        let upper = flat.iter().map(|point| [point.x, point.y, dent(point.x, point.y)]);
        let lower = flat.iter().map(|point| [point.x + 0.3, point.y + 0.2, 0.01 * point.x]);
        let positions: Vec<[f64; 3]> = upper.chain(lower).collect();
        let size = u32::try_from(flat.len()).unwrap();
        let second = sheet_faces(24, 6).into_iter().map(|face| face.map(|corner| corner + size));
        let faces = sheet_faces(24, 6).into_iter().chain(second).collect();
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let analysis = analyse(&mesh, &frame);
        let (mut islands, mut domain) = (Islands::default(), Domain::default());
        islands.find(&mesh, &analysis, &[], usize::MAX / 2);
        assert_eq!(islands.len(), 3);
        domain.grow(&mesh, mesh.vertex_ids(), 0);
        let limits = StrainLimits::of(&mesh, &frame);
        let before = frame.positions();
        let seams = Seams { mesh: &mesh, domain: &domain, islands: &islands, limits: &limits, before };
        let moved = |distance: f64| -> Vec<Point3<f64>> {
            let is_first = |vertex: usize| islands.of(VertexId::from_index(vertex)) == 0;
            let shift = |vertex: usize| nalgebra::Vector3::x() * if is_first(vertex) { -distance } else { 0.0 };
            before.iter().enumerate().map(|(vertex, point)| point + shift(vertex)).collect()
        };
        let mut groups = Groups::of_single_islands(4);
        assert!(!groups.join_torn(&seams, &moved(0.3)));
        assert_eq!(groups.members().len(), 4);
        assert!(groups.join_torn(&seams, &moved(1.5)));
        assert_eq!(groups.members(), [vec![0, 1], vec![2], vec![3]]);
        assert!(!groups.join_torn(&seams, &moved(1.5)), "what is joined already is not joined again");
    }
}
