//! Groups of triangles whose pairs need no look: a polygon of many corners that lies in one plane, or of which one
//! crossing is known already; and all bodies.
//!
//! The triangles of such a polygon are long, and the boxes of most pairs of them overlap.

use crate::{
    polygon::PolygonRef,
    primitive::{Point, Sign, orient2d, orient3d, project},
};

/// The group of a triangle that belongs to none.
pub(crate) const NO_GROUP: u32 = u32::MAX;
/// Polygons of no more corners have few pairs of triangles.
const FEW: usize = 16;

/// Groups of triangles, each open or closed. Pairs of a closed group are left out.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    /// Of each triangle; what is beyond the end belongs to none.
    of_triangle: Vec<u32>,
    is_closed: Vec<bool>,
    /// That of all polygons of bodies.
    body: Option<u32>,
}

impl Groups {
    /// Adds the triangles of a polygon, up to number `num_triangles`. They form a group if the polygon has many
    /// corners; it is closed if these lie in one plane, to the bit: triangles in one plane touch or cover each other,
    /// but none crosses another.
    ///
    /// All polygons of bodies together form one closed group.
    ///
    /// Cost: linear in the corners.
    pub(crate) fn add(&mut self, positions: &[Point], polygon: PolygonRef<'_>, num_triangles: usize) {
        if polygon.is_body {
            let body = *self.body.get_or_insert_with(|| {
                self.is_closed.push(true);
                u32::try_from(self.is_closed.len() - 1).unwrap_or(NO_GROUP)
            });
            self.of_triangle.resize(num_triangles, body);
            return;
        }
        if polygon.corners.len() <= FEW {
            self.of_triangle.resize(num_triangles, NO_GROUP);
            return;
        }
        self.of_triangle.resize(num_triangles, u32::try_from(self.is_closed.len()).unwrap_or(NO_GROUP));
        // What is not valid is refused elsewhere.
        let place = |&corner: &u32| positions.get(corner as usize).copied().unwrap_or([f64::NAN; 3]);
        let places = || polygon.corners.iter().map(place);
        self.is_closed.push(places().flatten().all(f64::is_finite) && is_flat(places));
    }

    /// The group of a triangle, or [`NO_GROUP`].
    pub(crate) fn of(&self, triangle: usize) -> u32 {
        self.of_triangle.get(triangle).copied().unwrap_or(NO_GROUP)
    }

    /// Whether pairs of a group are left out.
    pub(crate) fn is_closed(&self, group: u32) -> bool {
        self.is_closed.get(group as usize).copied().unwrap_or(false)
    }

    /// Leaves out all further pairs of the group that two triangles have in common, if they have one.
    pub(crate) fn close_common(&mut self, first: u32, second: u32) {
        let [first, second] = [first, second].map(|triangle| self.of(triangle as usize));
        if first == second && first != NO_GROUP {
            self.is_closed[first as usize] = true;
        }
    }
}

fn is_flat<I: Iterator<Item = Point>>(places: impl Fn() -> I) -> bool {
    let Some(a) = places().next() else { return true };
    let Some(b) = places().find(|point| ![a].contains(point)) else { return true };
    let Some(c) = places().find(|&point| has_area([a, b, point])) else { return true };
    places().all(|point| orient3d(a, b, c, point) == Sign::Zero)
}

fn has_area([a, b, c]: [Point; 3]) -> bool {
    (0..3).any(|axis| orient2d(project(a, axis), project(b, axis), project(c, axis)) != Sign::Zero)
}
