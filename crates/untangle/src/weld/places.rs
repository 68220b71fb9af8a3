//! Which vertices lie in one place.

use std::{cmp::Ordering, collections::HashMap, ops::Range};

use super::groups::Groups;

/// For each vertex the lowest vertex in its place.
pub(super) type Places = Vec<u32>;

/// Vertices of one part whose coordinates are equal are in one place.
pub(super) fn exact(positions: &[[f64; 3]], part: &[u32]) -> Places {
    let mut places: Places = (0..u32::try_from(positions.len()).unwrap_or(u32::MAX)).collect();
    let mut order = places.clone();
    // Adding zero makes one of the two zeros, which are one place.
    let key = |vertex: u32| positions[vertex as usize].map(|value| value + 0.0);
    let compare = |&a: &u32, &b: &u32| -> Ordering {
        let ([ax, ay, az], [bx, by, bz]) = (key(a), key(b));
        let by_place = ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(az.total_cmp(&bz));
        by_place.then(part[a as usize].cmp(&part[b as usize])).then(a.cmp(&b))
    };
    order.sort_unstable_by(compare);
    for pair in order.windows(2) {
        let is_same = part[pair[0] as usize] == part[pair[1] as usize]
            && key(pair[0]).iter().zip(key(pair[1])).all(|(a, b)| a.to_bits() == b.to_bits());
        if is_same {
            places[pair[1] as usize] = places[pair[0] as usize];
        }
    }
    places
}

/// Vertices of one part joined by a chain of vertices, each at most `distance_m` from the next, are in one place.
///
/// Vertices are put into cells of half that side. A cell is smaller than the distance, so all of it is one place; two
/// cells up to two steps apart are joined by the first two vertices that are near enough. A distance that coordinates
/// of this size can't resolve is none.
pub(super) fn within(positions: &[[f64; 3]], part: &[u32], distance_m: f64) -> Places {
    let largest = positions.iter().flatten().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if distance_m < largest * f64::EPSILON * 8.0 {
        return exact(positions, part);
    }
    let cell_of = |vertex: usize| positions[vertex].map(|value| (value / (0.5 * distance_m)).floor() + 0.0);
    let mut cells: HashMap<(u32, [u64; 3]), Vec<u32>> = HashMap::new();
    let mut groups = Groups::new(positions.len());
    for (vertex, id) in (0..positions.len()).zip(0..) {
        let cell = cells.entry((part[vertex], cell_of(vertex).map(f64::to_bits))).or_default();
        if let Some(&first) = cell.first() {
            groups.join(first, id);
        }
        cell.push(id);
    }
    let is_near = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|vertex| positions[vertex as usize]);
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt() <= distance_m
    };
    // The order of cells plays no part: joining is the same in any order.
    for ((part, cell), own) in &cells {
        for step in 0..125 {
            let steps = [step % 5, step / 5 % 5, step / 25].map(|step| f64::from(step) - 2.0);
            let next: [u64; 3] = std::array::from_fn(|axis| (f64::from_bits(cell[axis]) + steps[axis] + 0.0).to_bits());
            let Some(others) = cells.get(&(*part, next)) else { continue };
            if next == *cell || groups.first(own[0]) == groups.first(others[0]) {
                continue;
            }
            if own.iter().any(|&a| others.iter().any(|&b| is_near(a, b))) {
                groups.join(own[0], others[0]);
            }
        }
    }
    groups.into_firsts()
}

/// The part of each vertex, from 2 in even numbers, 0 for a vertex of none; a vertex of a body is in the odd part after
/// that.
pub(super) fn parts_of(num_vertices: usize, ranges: &[Range<usize>], body: &[u32]) -> Vec<u32> {
    let mut part = vec![0; num_vertices];
    for (number, range) in (1..).zip(ranges) {
        part[range.start.min(num_vertices)..range.end.min(num_vertices)].fill(2 * number);
    }
    for &vertex in body {
        part[vertex as usize] |= 1;
    }
    part
}
