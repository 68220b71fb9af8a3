//! Faces, edges, and which of them intersect.

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet, HashMap},
};

use super::{
    moved::{MAX_VERTICES, is_positive},
    number::{Point, point},
};

/// An edge by its vertices, ascending.
pub(super) type Edge = [u32; 2];

/// What intersects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Found {
    /// Edges, each with the number of a face that it pierces.
    pub piercings: BTreeSet<(Edge, usize)>,
    /// Pairs of faces by their numbers, ascending.
    pub faces: BTreeSet<[usize; 2]>,
}

/// Faces over moved vertices.
#[derive(Debug)]
pub(super) struct Surface {
    points: Vec<Point>,
    /// By their numbers, those alone that can intersect something.
    faces: BTreeMap<usize, [u32; 3]>,
    is_body: Vec<bool>,
    /// Signs by the vertices in ascending order.
    signs: RefCell<HashMap<[u32; 4], bool>>,
}

impl Surface {
    /// The faces of a mesh; nothing where a coordinate is refused. `body` are the vertices of bodies.
    ///
    /// # Panics
    /// With more vertices than exponents fit for, some forty.
    pub(super) fn new(positions: &[[f64; 3]], faces: &[[u32; 3]], body: &[u32]) -> Option<Self> {
        assert!(positions.len() <= MAX_VERTICES, "{} vertices", positions.len());
        let points = positions.iter().map(|&place| point(place)).collect::<Option<_>>()?;
        // Rule 4.
        let usable = faces.iter().copied().enumerate().filter(|(_, [a, b, c])| a != b && b != c && c != a);
        let is_body = (0..positions.len() as u32).map(|vertex| body.contains(&vertex)).collect();
        Some(Self { points, faces: usable.collect(), is_body, signs: RefCell::default() })
    }

    /// The places of all vertices, as they count.
    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    /// Faces by their numbers.
    pub(super) fn faces(&self) -> impl Iterator<Item = (usize, [u32; 3])> {
        self.faces.iter().map(|(&number, &corners)| (number, corners))
    }

    /// Rule 4: all edges.
    pub(super) fn edges(&self) -> BTreeSet<Edge> {
        self.faces.values().flat_map(|&corners| edges_of(corners)).collect()
    }

    /// Whether two vertices are both of bodies.
    pub(super) fn are_bodies(&self, a: u32, b: u32) -> bool {
        self.is_body[a as usize] && self.is_body[b as usize]
    }

    /// Rule 7: all that intersects.
    pub(super) fn intersections(&self) -> Found {
        let mut found = Found::default();
        for edge in self.edges() {
            for (number, corners) in self.faces() {
                if !self.are_bodies(edge[0], corners[0]) && self.pierces(edge, corners) {
                    found.piercings.insert((edge, number));
                }
            }
        }
        for (first, a) in self.faces() {
            for (second, b) in self.faces().filter(|(second, _)| *second > first) {
                let num_common = a.iter().filter(|vertex| b.contains(vertex)).count();
                let num_piercings = edges_of(a).filter(|&edge| found.piercings.contains(&(edge, second))).count()
                    + edges_of(b).filter(|&edge| found.piercings.contains(&(edge, first))).count();
                // Rule 6, of which the numbers follow: a judge that breaks them is wrong itself.
                let expected: &[usize] = [&[0, 2][..], &[0, 1], &[0], &[0]][num_common];
                assert!(expected.contains(&num_piercings), "{num_piercings} of {a:?} and {b:?}");
                if num_piercings > 0 {
                    found.faces.insert([first, second]);
                }
            }
        }
        found
    }

    /// Rule 5. The segment crosses the plane if its ends lie on different sides. The point where it does lies within
    /// the triangle if the segment, as a line, passes all three sides turning the same way.
    fn pierces(&self, [p, q]: Edge, [a, b, c]: [u32; 3]) -> bool {
        if [a, b, c].contains(&p) || [a, b, c].contains(&q) {
            return false;
        }
        self.sign([a, b, c, p]) != self.sign([a, b, c, q]) && {
            let turn = self.sign([p, q, a, b]);
            turn == self.sign([p, q, b, c]) && turn == self.sign([p, q, c, a])
        }
    }

    /// Whether the sign of four vertices is positive. A swap of two turns it round.
    pub(super) fn sign(&self, vertices: [u32; 4]) -> bool {
        let mut sorted = vertices;
        sorted.sort_unstable();
        let inversions =
            (0..4).flat_map(|i| (0..i).map(move |k| [k, i])).filter(|&[k, i]| vertices[k] > vertices[i]).count();
        let positive = *self.signs.borrow_mut().entry(sorted).or_insert_with(|| is_positive(&self.points, sorted));
        positive == inversions.is_multiple_of(2)
    }
}

fn edges_of([a, b, c]: [u32; 3]) -> impl Iterator<Item = Edge> {
    [[a, b], [b, c], [c, a]].into_iter().map(|[p, q]| [p.min(q), p.max(q)])
}
