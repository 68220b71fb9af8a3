//! The sign of a determinant of the perturbed input where that of the input itself is exactly zero.

use robust::Coord;

use super::{Side, Site};

/// The side of the plane through the first three sites on which the fourth lies, where their determinant is exactly
/// zero.
pub(super) fn perturbed_side(mut sites: [Site; 4]) -> Side {
    let odd = sort_by_index(&mut sites);
    debug_assert!(sites.windows(2).all(|pair| pair[0].index < pair[1].index), "two sites share an index");
    let [first, others @ ..] = &sites;
    // In one place all minors vanish but the last: a frame of zeros is nothing else.
    let minors = if others.iter().all(|site| same_place(first, site)) { &MINORS[13..] } else { &MINORS[..] };
    for minor in minors {
        if let Some(side) = minor.sign(&sites) {
            return side.flipped_if(odd);
        }
    }
    unreachable!("no minor of vertices {:?} has a sign, but the last one is constant", sites.map(|site| site.index))
}

#[expect(clippy::float_cmp, reason = "exactly the same place")]
fn same_place(a: &Site, b: &Site) -> bool {
    a.position == b.position
}

/// Sorts by index; true if the permutation is odd.
fn sort_by_index(sites: &mut [Site; 4]) -> bool {
    let mut odd = false;
    for end in (1..4).rev() {
        for k in 0..end {
            if sites[k].index > sites[k + 1].index {
                sites.swap(k, k + 1);
                odd = !odd;
            }
        }
    }
    odd
}

/// One coefficient of the perturbed determinant.
///
/// The determinant has the rows `(x, y, z, 1)` of the four sites, sorted by index. Site `i` moves by `e(i, j)` in
/// coordinate `j`, where `e(0, z) >> e(0, y) >> e(0, x) >> e(1, z) >> ...`, each smaller than the product of all those
/// before it: `e`, `e^2`, `e^4` and so on. The coefficient of a product of such terms is, up to its sign, the
/// determinant without the rows and columns of the factors.
struct Minor {
    /// Rows (sites) that stay.
    rows: &'static [usize],
    /// Coordinates that stay, besides the column of ones.
    columns: &'static [usize],
    /// Whether the cofactor's sign is negative, in the sense of [`side_of_plane`].
    negative: bool,
}

const X: usize = 0;
const Y: usize = 1;
const Z: usize = 2;

/// In the order of magnitude of their perturbations; derived by expanding the determinant, checked by
/// the tests against a symbolic move of all points.
const MINORS: [Minor; 14] = [
    Minor { rows: &[1, 2, 3], columns: &[X, Y], negative: true },
    Minor { rows: &[1, 2, 3], columns: &[X, Z], negative: false },
    Minor { rows: &[1, 2, 3], columns: &[Y, Z], negative: true },
    Minor { rows: &[0, 2, 3], columns: &[X, Y], negative: false },
    Minor { rows: &[2, 3], columns: &[X], negative: true },
    Minor { rows: &[2, 3], columns: &[Y], negative: false },
    Minor { rows: &[0, 2, 3], columns: &[X, Z], negative: true },
    Minor { rows: &[2, 3], columns: &[Z], negative: true },
    Minor { rows: &[0, 2, 3], columns: &[Y, Z], negative: false },
    Minor { rows: &[0, 1, 3], columns: &[X, Y], negative: true },
    Minor { rows: &[1, 3], columns: &[X], negative: false },
    Minor { rows: &[1, 3], columns: &[Y], negative: true },
    Minor { rows: &[0, 3], columns: &[X], negative: true },
    Minor { rows: &[3], columns: &[], negative: true },
];

impl Minor {
    /// The side that this coefficient decides, or nothing where it vanishes.
    fn sign(&self, sites: &[Site; 4]) -> Option<Side> {
        let at = |row: usize, column: usize| sites[self.rows[row]].position[self.columns[column]];
        let value = match self.columns.len() {
            2 => robust::orient2d(
                Coord { x: at(0, 0), y: at(0, 1) },
                Coord { x: at(1, 0), y: at(1, 1) },
                Coord { x: at(2, 0), y: at(2, 1) },
            ),
            // A difference of doubles has the right sign, with gradual underflow even next to zero.
            1 => at(0, 0) - at(1, 0),
            _ => 1.0,
        };
        if value > 0.0 {
            Some(Side::Above.flipped_if(self.negative))
        } else if value < 0.0 {
            Some(Side::Below.flipped_if(self.negative))
        } else {
            None
        }
    }
}
