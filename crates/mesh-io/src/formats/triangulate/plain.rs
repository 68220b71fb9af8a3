//! Clipping ears by looking at all corners, for each.

use robust::{Coord, orient2d};

/// The corners of a polygon, in space and in the plane in which it runs counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon<'a> {
    pub(super) points: &'a [[f64; 3]],
    pub(super) plane: &'a [Coord<f64>],
}

impl Polygon<'_> {
    pub(super) fn turns_left(self, a: usize, b: usize, c: usize) -> bool {
        orient2d(self.plane[a], self.plane[b], self.plane[c]) > 0.0
    }

    /// Whether a corner keeps three others from being an ear: it lies in their triangle or on its border. A corner at
    /// the same place as one of the ear's is a bridge to a hole, not an obstacle.
    pub(super) fn obstructs(self, other: usize, ear: [usize; 3]) -> bool {
        let [a, b, c] = ear;
        let is_left = |a: usize, b: usize| orient2d(self.plane[a], self.plane[b], self.plane[other]) >= 0.0;
        !ear.contains(&other)
            && !ear.map(|corner| self.points[corner]).contains(&self.points[other])
            && is_left(a, b)
            && is_left(b, c)
            && is_left(c, a)
    }
}

/// Clips ears by looking at all corners for each. Cost: O(n^2) for a convex polygon, O(n^3) for others.
pub(super) fn clip(polygon: Polygon<'_>, emit: &mut dyn FnMut([usize; 3])) {
    let mut ring: Vec<usize> = (0..polygon.points.len()).collect();
    let (mut at, mut failures) = (1, 0);
    while ring.len() > 3 && failures < ring.len() {
        let count = ring.len();
        at %= count;
        let ear = [ring[(at + count - 1) % count], ring[at], ring[(at + 1) % count]];
        let [before, tip, after] = ear;
        if polygon.turns_left(before, tip, after) && !ring.iter().any(|&other| polygon.obstructs(other, ear)) {
            emit(ear);
            ring.remove(at);
            // Staying where the ear was makes the fan of the first corner out of a convex polygon.
            failures = 0;
            if at == ring.len() {
                at = 1;
            }
        } else {
            at += 1;
            failures += 1;
        }
    }
    emit_fan(&ring, emit);
}

/// The triangles of the first corner with all edges of the ring that do not touch it.
pub(super) fn emit_fan(ring: &[usize], emit: &mut dyn FnMut([usize; 3])) {
    for pair in ring.windows(2).skip(1) {
        emit([ring[0], pair[0], pair[1]]);
    }
}
