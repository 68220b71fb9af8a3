//! Which vertices in one place are one vertex.

use super::{groups::Groups, places::Places};
use crate::mesh::is_usable;

/// A side of a face of which at least one end has company in its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The places of both ends, the lower one first.
    places: [u32; 2],
    /// The ends, in the order of their places.
    ends: [u32; 2],
    face: u32,
}

/// The lowest vertex of each vertex's group. Seams are sought between the vertices that are `near`, edges without
/// length between those in `exact`ly one place.
pub(super) fn find(faces: &[[u32; 3]], near: &Places, exact: &Places) -> Vec<u32> {
    let mut groups = Groups::new(near.len());
    let has_company = company(near);
    if has_company.iter().any(|&has| has) {
        sew(faces, near, &has_company, &mut groups);
        let sewn = groups.clone();
        contract(faces, &short_edges(faces, exact), &mut groups);
        // A cloth that lies wholly in points or on lines keeps its faces.
        if !faces.iter().any(|corners| is_usable(corners.map(|corner| groups.first(corner)))) {
            groups = sewn;
        }
        take_along(faces, near, &has_company, &mut groups);
    }
    groups.into_firsts()
}

/// For each vertex whether another one is in its place.
fn company(places: &Places) -> Vec<bool> {
    let mut counts = vec![0u32; places.len()];
    for &place in places {
        counts[place as usize] += 1;
    }
    places.iter().map(|&place| counts[place as usize] > 1).collect()
}

/// Joins the ends of edges that lie in one place.
fn sew(faces: &[[u32; 3]], places: &Places, has_company: &[bool], groups: &mut Groups) {
    let place = |vertex: u32| places[vertex as usize];
    let mut sides: Vec<Side> = Vec::new();
    for (face, corners) in (0..).zip(faces).filter(|(_, corners)| is_usable(**corners)) {
        for [a, b] in [[corners[0], corners[1]], [corners[1], corners[2]], [corners[2], corners[0]]] {
            if place(a) != place(b) && (has_company[a as usize] || has_company[b as usize]) {
                let ends = if place(a) < place(b) { [a, b] } else { [b, a] };
                sides.push(Side { places: ends.map(place), ends, face });
            }
        }
    }
    sides.sort_unstable();
    let short = short_edges(faces, places);
    let winding = |side: &Side| winding(faces[side.face as usize].map(place));
    for in_place in sides.chunk_by(|a, b| a.places == b.places) {
        let edges: Vec<&[Side]> = in_place.chunk_by(|a, b| a.ends == b.ends).collect();
        let (borders, inner): (Vec<&[Side]>, Vec<&[Side]>) = edges.iter().partition(|edge| edge.len() == 1);
        // Where two edges that are no boundary lie in one place, sheets touch or cross there.
        let partners = if let [only] = inner[..] { [&borders[..], &[only]].concat() } else { borders.clone() };
        for (index, border) in borders.iter().enumerate() {
            for partner in &partners[index + 1..] {
                let is_layer = |side: &Side| winding(side) == winding(&border[0]);
                let pairs = [0, 1].map(|end| [border[0].ends[end], partner[0].ends[end]]);
                let is_beside = |[a, b]: [u32; 2]| short.binary_search(&[a.min(b), a.max(b)]).is_ok();
                // Two boundaries whose faces coincide and face the same way are those of two layers, not two sides of a
                // seam. The two long sides of a face without width are no seam either.
                let are_layers = partner.len() == 1 && is_layer(&partner[0]);
                if are_layers || pairs.into_iter().any(is_beside) {
                    continue;
                }
                for [a, b] in pairs {
                    groups.join(a, b);
                }
            }
        }
    }
}

/// The corners of a face, turned so that the lowest is first: equal for faces that coincide and face the same way.
fn winding([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The edges whose ends are in one place, ascending.
fn short_edges(faces: &[[u32; 3]], places: &Places) -> Vec<[u32; 2]> {
    let sides = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let usable = faces.iter().filter(|corners| is_usable(**corners));
    let is_short = |[a, b]: &[u32; 2]| places[*a as usize] == places[*b as usize];
    let mut short: Vec<[u32; 2]> = usable.flat_map(sides).filter(is_short).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    short.sort_unstable();
    short.dedup();
    short
}

/// Contracts edges without length where that leaves the cloth what it was: the ends have no common neighbour but the
/// tips of the faces at the edge, and not both lie on the boundary unless the edge does (Dey et al. 1999).
fn contract(faces: &[[u32; 3]], short: &[[u32; 2]], groups: &mut Groups) {
    let mut ends = short.as_flattened().to_vec();
    ends.sort_unstable();
    // The neighbours of the ends, once for each face beside the edge to them.
    let mut spokes: Vec<[u32; 2]> = Vec::new();
    if !ends.is_empty() {
        for corners in faces.iter().filter(|corners| is_usable(**corners)) {
            for (k, &corner) in corners.iter().enumerate().filter(|(_, corner)| ends.binary_search(corner).is_ok()) {
                spokes.extend([(k + 1) % 3, (k + 2) % 3].map(|other| [corner, corners[other]]));
            }
        }
    }
    spokes.sort_unstable();
    let of = |end: u32| {
        let first = spokes.partition_point(|spoke| spoke[0] < end);
        let last = spokes.partition_point(|spoke| spoke[0] <= end);
        spokes[first..last].chunk_by(|a, b| a == b).map(|same| (same[0][1], same.len()))
    };
    for &[a, b] in short {
        let num_faces = of(a).find(|(other, _)| *other == b).map_or(0, |(_, count)| count);
        let neighbours: Vec<u32> = of(b).map(|(other, _)| other).collect();
        let num_common = of(a).filter(|(other, _)| neighbours.binary_search(other).is_ok()).count();
        let on_boundary = |end: u32| of(end).any(|(_, count)| count == 1);
        if num_common == num_faces && (num_faces == 1 || !(on_boundary(a) && on_boundary(b))) {
            groups.join(a, b);
        }
    }
}

/// Joins each vertex of no face to the first vertex in its place that has one.
fn take_along(faces: &[[u32; 3]], places: &Places, has_company: &[bool], groups: &mut Groups) {
    let mut is_used = vec![false; places.len()];
    for &corner in faces.iter().flatten() {
        is_used[corner as usize] = true;
    }
    let mut host: Vec<Option<u32>> = vec![None; places.len()];
    let all = || (0..).zip(places);
    for (vertex, &place) in all().filter(|(vertex, _)| is_used[*vertex as usize]) {
        host[place as usize].get_or_insert(vertex);
    }
    for (vertex, &place) in all().filter(|(vertex, _)| !is_used[*vertex as usize] && has_company[*vertex as usize]) {
        let host = *host[place as usize].get_or_insert(vertex);
        groups.join(vertex, host);
    }
}
