//! Which polygons cross where a reader may split each of them as it likes.

use crate::{
    CheckError, Crossings,
    crossing::triangles_cross,
    primitive::Point,
    surface::{MOST_PAIRS, num_common},
    tree::Tree,
    validate,
};

/// Most corners of a polygon whose fans are all tried; of a larger one only that of its first corner is.
const MOST_CORNERS: usize = 16;

/// One polygon.
#[derive(Clone, Copy, Debug)]
pub struct PolygonRef<'a> {
    /// Its corners, in order.
    pub corners: &'a [u32],
    /// Its triangles as the program at hand splits it.
    pub triangles: &'a [[u32; 3]],
}

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
    let (mut triangles, mut candidates) = (Vec::new(), Vec::new());
    for (number, polygon) in (0..).zip(polygons) {
        add_candidates(number, polygon, &mut triangles, &mut candidates);
    }
    validate(positions, &triangles)?;
    let corners = |triangle: u32| triangles[triangle as usize].map(|vertex| positions[vertex as usize]);
    let mut pairs = Vec::new();
    Tree::new(positions, &triangles).pairs(&mut |first, second| {
        let [a, b] = [first, second].map(|index| &candidates[index as usize]);
        let coexist = a.polygon != b.polygon || a.ways & b.ways != 0;
        if coexist && num_common(triangles[first as usize], triangles[second as usize]) < 2 {
            let [p, q] = [first, second].map(corners);
            if triangles_cross(p, q) {
                pairs.push([a.polygon.min(b.polygon), a.polygon.max(b.polygon)]);
            }
        }
        pairs.len() < MOST_PAIRS
    });
    let is_complete = pairs.len() < MOST_PAIRS;
    pairs.sort_unstable();
    pairs.dedup();
    Ok(Crossings { pairs, is_complete })
}

fn add_candidates(
    polygon: u32,
    PolygonRef { corners, triangles: own }: PolygonRef<'_>,
    triangles: &mut Vec<[u32; 3]>,
    candidates: &mut Vec<Candidate>,
) {
    let first = triangles.len();
    let mut add = |triangle: [u32; 3], way: u32| {
        let is_same = |other: &[u32; 3]| num_common(triangle, *other) == 3 && num_common(*other, triangle) == 3;
        if let Some(at) = triangles[first..].iter().position(is_same) {
            candidates[first + at].ways |= way;
        } else {
            triangles.push(triangle);
            candidates.push(Candidate { polygon, ways: way });
        }
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
