//! Which polygons cross where a reader may split each of them as it likes.

use std::collections::BTreeMap;

use crate::{
    CheckError, Crossings,
    crossing::{are_apart, triangles_cross},
    groups::Groups,
    polygon::PolygonRef,
    primitive::Point,
    surface::{MOST_PAIRS, crossings_beyond_groups, num_common},
    tree::{Next, Tree},
    validate,
};

/// Most corners of a polygon whose fans are all tried; of a larger one only that of its first corner is.
const MOST_CORNERS: usize = 16;

/// A triangle that some reader sees.
struct Candidate {
    polygon: u32,
    /// The ways to split the polygon that have this triangle: bit `k` for the fan of corner `k`, one more for the given
    /// triangles.
    ways: u32,
}

/// Pairs of polygons of which some triangles cross properly, if each polygon may be split as given or into the fan of
/// any of its corners (of its first, if it has more than 16). A polygon that crosses itself in one of these ways is
/// paired with itself. Polygons are told by their numbers.
///
/// Only interiors of triangles are tested, not what runs exactly along edges.
///
/// Cost: that of [`crossings`](crate::crossings) for `n (n - 2)` triangles of a polygon of `n` corners.
///
/// # Errors
/// [`CheckError`], naming the vertex at fault.
pub fn fan_crossings<'a>(
    positions: &[Point],
    polygons: impl IntoIterator<Item = PolygonRef<'a>>,
) -> Result<Crossings, CheckError> {
    let (mut triangles, mut candidates, mut groups) = (Vec::new(), Vec::new(), Groups::default());
    for (number, polygon) in (0..).zip(polygons) {
        add_candidates(number, polygon, &mut triangles, &mut candidates);
        groups.add(positions, polygon, triangles.len());
    }
    validate(positions, &triangles)?;
    let corners = |triangle: u32| triangles[triangle as usize].map(|vertex| positions[vertex as usize]);
    let mut pairs = Vec::new();
    let tree = Tree::new(positions, &triangles, &groups);
    tree.pairs(&mut groups, &mut |first, second| {
        let [a, b] = [first, second].map(|index| &candidates[index as usize]);
        let coexist = a.polygon != b.polygon || a.ways & b.ways != 0;
        if !coexist || num_common(triangles[first as usize], triangles[second as usize]) > 1 {
            return Next::GoOn;
        }
        let [p, q] = [first, second].map(corners);
        if are_apart(p, q) || !triangles_cross(p, q) {
            return Next::GoOn;
        }
        pairs.push([a.polygon.min(b.polygon), a.polygon.max(b.polygon)]);
        if pairs.len() < MOST_PAIRS { Next::CloseGroup } else { Next::End }
    });
    let is_complete = pairs.len() < MOST_PAIRS;
    pairs.sort_unstable();
    pairs.dedup();
    Ok(Crossings { pairs, is_complete })
}

/// [`crossings`](crate::crossings) of the triangles of polygons, each split as given or, `from_first_corner`, into the
/// fan of its first corner. Of the crossings of such a fan with itself, if it has many corners, one is listed: of a
/// polygon that is not convex there are as many as its corners squared.
///
/// Cost: that of [`crossings`](crate::crossings), without the pairs of a polygon of many corners that lies in one
/// plane.
///
/// # Errors
/// [`CheckError`], naming the vertex at fault.
pub fn polygon_crossings<'a>(
    positions: &[Point],
    polygons: impl IntoIterator<Item = PolygonRef<'a>>,
    from_first_corner: bool,
) -> Result<Crossings, CheckError> {
    let (mut triangles, mut groups) = (Vec::new(), Groups::default());
    for polygon in polygons {
        if from_first_corner {
            let sides = polygon.corners.windows(2).skip(1);
            triangles.extend(sides.map(|side| [polygon.corners[0], side[0], side[1]]));
        } else {
            triangles.extend(polygon.triangles);
        }
        groups.add(positions, polygon, triangles.len());
    }
    validate(positions, &triangles)?;
    let on_crossing = if from_first_corner { Next::CloseGroup } else { Next::GoOn };
    Ok(crossings_beyond_groups(positions, &triangles, groups, on_crossing))
}

fn add_candidates(
    polygon: u32,
    PolygonRef { corners, triangles: own, .. }: PolygonRef<'_>,
    triangles: &mut Vec<[u32; 3]>,
    candidates: &mut Vec<Candidate>,
) {
    let mut known = BTreeMap::new();
    let mut add = |triangle: [u32; 3], way: u32| {
        let mut name = triangle;
        name.sort_unstable();
        let at = *known.entry(name).or_insert(triangles.len());
        if at == triangles.len() {
            triangles.push(triangle);
            candidates.push(Candidate { polygon, ways: 0 });
        }
        candidates[at].ways |= way;
    };
    for &triangle in own {
        add(triangle, 1 << MOST_CORNERS);
    }
    let count = corners.len();
    let num_fans = match count {
        0..=3 => 0,
        4..=MOST_CORNERS => count,
        _ => 1,
    };
    for (start, way) in (0..num_fans).zip(0..) {
        let corner = |step: usize| corners[(start + step) % count];
        for step in 1..count - 1 {
            add([corner(0), corner(step), corner(step + 1)], 1 << way);
        }
    }
}
