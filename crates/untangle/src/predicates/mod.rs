//! Exact signs on one consistently perturbed input: the only home of geometric decisions.
//!
//! Every vertex is thought to be moved by an infinitesimal amount that depends on its index alone (simulation of
//! simplicity, Edelsbrunner and Mücke 1990). On the moved input no four points lie in a plane, so that a sign is never
//! zero, and all signs together belong to *one* input: whatever is derived from them is consistent. The sign of the
//! unmoved determinant is found by adaptive exact arithmetic (Shewchuk 1997, crate `robust`); only where it is exactly
//! zero, the sign of the first coefficient of the perturbation that does not vanish decides.
//!
//! The arithmetic is exact as long as no product over- or underflows; [`Frame`](crate::frame::Frame) keeps coordinates
//! in the range where that holds.

mod plane;

pub(crate) use plane::Plane;
use robust::{Coord, Coord3D};

/// On which side of an oriented plane a point lies. There is no third answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Where the plane's vertices, seen from the point, run clockwise: a positive volume of (a, b, c, d), right-hand
    /// rule.
    Above,
    /// The other side.
    Below,
}

impl Side {
    /// The opposite side.
    #[must_use]
    pub fn flipped(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }

    fn flipped_if(self, odd: bool) -> Self {
        if odd { self.flipped() } else { self }
    }
}

/// A vertex as the predicates see it: its position and the index that decides its perturbation.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Position in metres.
    pub position: [f64; 3],
    /// Index of the vertex; no two sites of one query may share it.
    pub index: u32,
}

/// The side of the plane through `a`, `b`, `c` on which `d` lies: the sign of `(b - a) x (c - a) . (d - a)` on the
/// perturbed input.
///
/// Cost: one filtered determinant nearly always; exact expansions near zero; up to fourteen minors at exactly zero.
///
/// # Panics
/// In debug builds, if two sites have the same index.
#[must_use]
pub fn side_of_plane(a: Site, b: Site, c: Site, d: Site) -> Side {
    // `robust` counts a point below a counter-clockwise triangle as positive.
    let volume = -robust::orient3d(coord3(a), coord3(b), coord3(c), coord3(d));
    if volume > 0.0 {
        Side::Above
    } else if volume < 0.0 {
        Side::Below
    } else {
        perturbed_side([a, b, c, d])
    }
}

/// Whether four points lie exactly in one plane *before* any perturbation: for labels and reports, never for topology.
#[must_use]
pub fn are_coplanar(points: [[f64; 3]; 4]) -> bool {
    let [a, b, c, d] = points.map(|position| coord3(Site { position, index: 0 }));
    // Exact, so that zero means zero.
    robust::orient3d(a, b, c, d).classify() == std::num::FpCategory::Zero
}

/// The answer where the determinant itself is exactly zero.
fn perturbed_side(mut sites: [Site; 4]) -> Side {
    let odd = sort_by_index(&mut sites);
    debug_assert!(sites.windows(2).all(|pair| pair[0].index < pair[1].index), "two sites share an index");
    for minor in &MINORS {
        if let Some(side) = minor.sign(&sites) {
            return side.flipped_if(odd);
        }
    }
    unreachable!("the last minor is the constant one")
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
/// coordinate `j`, where `e(0, z) >> e(0, y) >> e(0, x) >> e(1, z) >> ...`, each larger than any product of those after
/// it. The coefficient of a product of such terms is, up to its sign, the determinant without the rows and columns of
/// the factors.
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
/// `minors_are_the_expansion_of_the_determinant`.
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

fn coord3(site: Site) -> Coord3D<f64> {
    let [x, y, z] = site.position;
    Coord3D { x, y, z }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "all numbers here are small")]
mod tests {
    use super::*;

    fn site(index: u32, x: f64, y: f64, z: f64) -> Site {
        Site { position: [x, y, z], index }
    }

    #[test]
    fn right_hand_rule() {
        let [a, b, c] = [site(0, 0., 0., 0.), site(1, 1., 0., 0.), site(2, 0., 1., 0.)];
        assert_eq!(side_of_plane(a, b, c, site(3, 0., 0., 1.)), Side::Above);
        assert_eq!(side_of_plane(a, b, c, site(3, 0., 0., -1.)), Side::Below);
    }

    /// The side after a move by symbols: numbers are polynomials in one infinitesimal, maps from exponents to integers,
    /// and the sign is that of the term with the lowest exponent. Shares nothing with the table of minors.
    fn moved_side(sites: &[Site; 4]) -> Side {
        use std::collections::BTreeMap;
        type Poly = BTreeMap<u32, i128>;
        fn mul(a: &Poly, b: &Poly) -> Poly {
            let mut out = Poly::new();
            for (ka, va) in a {
                for (kb, vb) in b {
                    *out.entry(ka + kb).or_default() += va * vb;
                }
            }
            out
        }
        fn sub(a: &Poly, b: &Poly) -> Poly {
            let mut out = a.clone();
            for (k, v) in b {
                *out.entry(*k).or_default() -= v;
            }
            out
        }
        fn add(a: &Poly, b: &Poly) -> Poly {
            let mut out = a.clone();
            for (k, v) in b {
                *out.entry(*k).or_default() += v;
            }
            out
        }
        let mut order: Vec<u32> = sites.iter().map(|s| s.index).collect();
        order.sort_unstable();
        let coordinate = |s: &Site, j: usize| {
            let rank = order.iter().position(|&i| i == s.index).unwrap() as u32;
            // The exponent of e(i, j) in powers of one tiny number: 2^(3 i + (z: 0, y: 1, x: 2)).
            let exponent = 1u32 << (3 * rank + (2 - j as u32));
            Poly::from([(0, s.position[j] as i128), (exponent, 1)])
        };
        let p: Vec<[Poly; 3]> = sites.iter().map(|s| [coordinate(s, 0), coordinate(s, 1), coordinate(s, 2)]).collect();
        let d = |i: usize, j: usize| sub(&p[i][j], &p[0][j]);
        let det2 = |r: usize, s: usize, j: usize, k: usize| sub(&mul(&d(r, j), &d(s, k)), &mul(&d(r, k), &d(s, j)));
        let det = add(
            &sub(&mul(&d(3, 0), &det2(1, 2, 1, 2)), &mul(&d(3, 1), &det2(1, 2, 0, 2))),
            &mul(&d(3, 2), &det2(1, 2, 0, 1)),
        );
        let leading = det.into_iter().find(|&(_, v)| v != 0).expect("no coefficient left").1;
        if leading > 0 { Side::Above } else { Side::Below }
    }

    #[test]
    fn minors_are_the_expansion_of_the_determinant() {
        // All positions of a tiny grid in which nearly every query is degenerate, with every order of the indices.
        let mut state = 1u64;
        let mut next = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..20_000 {
            let mut indices = [0u32, 1, 2, 3].map(|k| 4 * k + next(4) as u32);
            for k in (1..4).rev() {
                indices.swap(k, next(k as u64 + 1) as usize);
            }
            let range = 1 + next(3);
            let sites = indices.map(|index| site(index, next(range) as f64, next(range) as f64, next(range) as f64));
            let [a, b, c, d] = sites;
            assert_eq!(side_of_plane(a, b, c, d), moved_side(&sites), "{sites:?}");
            assert_eq!(side_of_plane(b, a, c, d), side_of_plane(a, b, c, d).flipped());
            assert_eq!(side_of_plane(b, c, a, d), side_of_plane(a, b, c, d));
            assert_eq!(side_of_plane(d, b, c, a), side_of_plane(a, b, c, d).flipped());
        }
    }
    /// The sign of the determinant in whole numbers, for coordinates below 2^39.
    fn whole_sign(sites: &[Site; 4]) -> i128 {
        let [a, b, c, d] = sites.map(|site| site.position.map(|x| x as i128));
        let minus = |p: [i128; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let [p, q, r] = [b, c, d].map(minus);
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        (cross[0] * r[0] + cross[1] * r[1] + cross[2] * r[2]).signum()
    }

    #[test]
    fn nearly_coplanar_points_have_the_sign_of_exact_arithmetic() {
        let mut state = 3u64;
        let mut next = |bits: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            i64::try_from(state >> (64 - bits)).unwrap() - (1 << (bits - 1))
        };
        let (mut num_zero, mut num_misjudged) = (0, 0);
        for _ in 0..20_000 {
            // A thin triangle, and a point in its plane or one unit off it in one coordinate.
            let (a, u) = ([next(36), next(36), next(36)], [next(33), next(33), next(33)]);
            let v = u.map(|x| 3 * x + next(6));
            let [s, t] = [next(4), next(4)];
            let mut d = [0, 1, 2].map(|axis| a[axis] + s * u[axis] + t * v[axis]);
            d[usize::try_from(next(3).rem_euclid(3)).unwrap()] += next(2);
            let add = |p: [i64; 3], q: [i64; 3]| [p[0] + q[0], p[1] + q[1], p[2] + q[2]];
            let corners = [a, add(a, u), add(a, v), d].map(|corner| corner.map(|x| x as f64));
            let sites =
                [0, 1, 2, 3].map(|k| site(k, corners[k as usize][0], corners[k as usize][1], corners[k as usize][2]));
            let [a, b, c, d] = sites;
            match whole_sign(&sites) {
                0 => {
                    num_zero += 1;
                    assert!(are_coplanar(corners));
                    assert_eq!(side_of_plane(a, b, c, d), moved_side(&sites));
                }
                sign => {
                    assert!(!are_coplanar(corners));
                    let expected = if sign > 0 { Side::Above } else { Side::Below };
                    assert_eq!(side_of_plane(a, b, c, d), expected, "{sites:?}");
                    num_misjudged += usize::from((plain_volume(&corners) > 0.0) != (sign > 0));
                }
            }
        }
        // Or the points are too easy to be a test.
        assert!(num_zero > 1_000 && num_misjudged > 100, "{num_zero} {num_misjudged}");
    }

    /// The determinant in plain double arithmetic.
    fn plain_volume([a, b, c, d]: &[[f64; 3]; 4]) -> f64 {
        let minus = |p: &[f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let [p, q, r] = [b, c, d].map(minus);
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        cross[0] * r[0] + cross[1] * r[1] + cross[2] * r[2]
    }
}
