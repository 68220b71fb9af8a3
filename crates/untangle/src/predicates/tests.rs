//! The predicates against symbolic and integer arithmetic.

#![allow(clippy::cast_possible_truncation, reason = "all numbers here are small")]

use super::{Side, Site, are_coplanar, side_of_plane};

fn site(index: u32, x: f64, y: f64, z: f64) -> Site {
    Site { position: [x, y, z], index }
}

#[test]
fn side_of_plane_follows_the_right_hand_rule() {
    let [a, b, c] = [site(0, 0., 0., 0.), site(1, 1., 0., 0.), site(2, 0., 1., 0.)];
    assert_eq!(side_of_plane(a, b, c, site(3, 0., 0., 1.)), Side::Above);
    assert_eq!(side_of_plane(a, b, c, site(3, 0., 0., -1.)), Side::Below);
}

/// The side after a symbolic move: numbers are polynomials in one infinitesimal, maps from exponents to integers, and
/// the sign is that of the term with the lowest exponent. Shares no code with the table of minors.
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
fn side_of_plane_of_degenerate_points_is_that_after_a_symbolic_move() {
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
fn side_of_plane_of_nearly_coplanar_points_is_that_of_integer_arithmetic() {
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
    // Fewer would mean that the points are too easy to test anything.
    assert!(num_zero > 1_000 && num_misjudged > 100, "{num_zero} {num_misjudged}");
}

/// The determinant in plain double arithmetic.
fn plain_volume([a, b, c, d]: &[[f64; 3]; 4]) -> f64 {
    let minus = |p: &[f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let [p, q, r] = [b, c, d].map(minus);
    let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    cross[0] * r[0] + cross[1] * r[1] + cross[2] * r[2]
}
