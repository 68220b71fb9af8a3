//! Which triangles of a surface cross properly.

use crate::{
    CheckError,
    crossing::{alternate, are_apart, interiors_cross, overlap, runs_through, sides, tip_of_edge_in_plane},
    groups::Groups,
    primitive::{Point, Sign},
    tree::{Next, Tree},
    validate,
};

/// Most pairs that are listed: a cloth that crosses itself more often is not repaired by looking at a list.
pub(crate) const MOST_PAIRS: usize = 1_000_000;

/// Pairs that cross properly.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Lower index first, ascending.
    pub pairs: Vec<[u32; 2]>,
    /// Whether these are all; the search ends at a million.
    pub is_complete: bool,
}

/// Pairs of triangles that cross properly, those that share one vertex among them. Triangles that share two vertices
/// don't cross, and a triangle without area crosses nothing.
///
/// Cost: O(n log n) and a test for each pair of triangles whose boxes overlap.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn crossings(positions: &[Point], triangles: &[[u32; 3]]) -> Result<Crossings, CheckError> {
    validate(positions, triangles)?;
    Ok(crossings_beyond_groups(positions, triangles, Groups::default(), Next::GoOn))
}

/// [`crossings`] of valid triangles, without pairs of closed groups; what to do after each crossing is
/// `on_crossing`.
pub(crate) fn crossings_beyond_groups(
    positions: &[Point],
    triangles: &[[u32; 3]],
    mut groups: Groups,
    on_crossing: Next,
) -> Crossings {
    let surface = Surface::new(positions, triangles);
    let mut pairs = Vec::new();
    let tree = Tree::new(positions, triangles, &groups);
    tree.pairs(&mut groups, &mut |first, second| {
        if !surface.cross(first, second) {
            return Next::GoOn;
        }
        pairs.push([first, second]);
        if pairs.len() < MOST_PAIRS { on_crossing } else { Next::End }
    });
    let is_complete = pairs.len() < MOST_PAIRS;
    pairs.sort_unstable();
    Crossings { pairs, is_complete }
}

/// The number of vertices that two triangles share.
pub(crate) fn num_common(first: [u32; 3], second: [u32; 3]) -> usize {
    first.iter().filter(|vertex| second.contains(vertex)).count()
}

/// Triangles with what lies round their edges.
struct Surface<'a> {
    positions: &'a [Point],
    triangles: &'a [[u32; 3]],
    /// The ends of each edge, the lower one first, and the corner opposite to it in one triangle; ascending.
    wings: Vec<([u32; 2], u32)>,
}

impl<'a> Surface<'a> {
    fn new(positions: &'a [Point], triangles: &'a [[u32; 3]]) -> Self {
        let sides =
            |&[a, b, c]: &[u32; 3]| [([a.min(b), a.max(b)], c), ([b.min(c), b.max(c)], a), ([c.min(a), c.max(a)], b)];
        let mut wings: Vec<([u32; 2], u32)> = triangles.iter().flat_map(sides).collect();
        wings.sort_unstable();
        Self { positions, triangles, wings }
    }

    fn corners(&self, triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize])
    }

    fn cross(&self, first: u32, second: u32) -> bool {
        if num_common(self.triangles[first as usize], self.triangles[second as usize]) > 1 {
            return false;
        }
        let [a, b] = [first, second].map(|triangle| self.corners(triangle));
        if are_apart(a, b) {
            return false;
        }
        let a_sides = sides(a, b);
        if a_sides == [Sign::Positive; 3] || a_sides == [Sign::Negative; 3] {
            return false;
        }
        let b_sides = sides(b, a);
        if interiors_cross(a, b, [a_sides, b_sides]) {
            return true;
        }
        let in_b = tip_of_edge_in_plane(a_sides).map(|tip| Edge::new(self, first, tip));
        let in_a = tip_of_edge_in_plane(b_sides).map(|tip| Edge::new(self, second, tip));
        in_b.as_ref().is_some_and(|edge| edge.crosses(self, second))
            || in_a.as_ref().is_some_and(|edge| edge.crosses(self, first))
            || in_b.zip(in_a).is_some_and(|(first, second)| first.alternates_with(self, &second))
    }

    /// The corners opposite to an edge, one for each triangle at it.
    fn wings_of(&self, edge: [u32; 2]) -> impl Iterator<Item = Point> {
        let first = self.wings.partition_point(|(other, _)| *other < edge);
        let all = self.wings[first..].iter().take_while(move |(other, _)| *other == edge);
        all.map(|&(_, tip)| self.positions[tip as usize])
    }
}

/// An edge of a triangle.
struct Edge {
    vertices: [u32; 2],
    ends: [Point; 2],
    /// The corner of the triangle opposite to it.
    tip: Point,
}

impl Edge {
    fn new(surface: &Surface<'_>, triangle: u32, tip: usize) -> Self {
        let corners = surface.triangles[triangle as usize];
        let [a, b] = [corners[(tip + 1) % 3], corners[(tip + 2) % 3]];
        let at = |vertex: u32| surface.positions[vertex as usize];
        Self { vertices: [a.min(b), a.max(b)], ends: [a, b].map(at), tip: at(corners[tip]) }
    }

    /// Whether the edge, which lies in the plane of a triangle, runs through its interior with triangles on both sides.
    fn crosses(&self, surface: &Surface<'_>, triangle: u32) -> bool {
        let other = surface.corners(triangle);
        let side_of = |point: Point| sides([point; 3], other)[0];
        let here = side_of(self.tip);
        let is_beyond = |side: Sign| side != Sign::Zero && side != here;
        runs_through(self.ends, other) && surface.wings_of(self.vertices).any(|tip| is_beyond(side_of(tip)))
    }

    /// Whether two edges lie over each other and the triangles round them alternate.
    fn alternates_with(&self, surface: &Surface<'_>, other: &Self) -> bool {
        overlap(self.ends, other.ends)
            && surface.wings_of(self.vertices).any(|own| {
                let mut others = surface.wings_of(other.vertices);
                others.any(|wing| alternate(self.ends, [self.tip, own], [other.tip, wing]))
            })
    }
}
