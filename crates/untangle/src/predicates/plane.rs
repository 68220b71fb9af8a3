//! One plane against many points: the part of the determinant that does not depend on the point is computed once.

use super::{Side, Site, perturbation::perturbed_side, side_of_plane};

/// Forward error bound of the determinant below, relative to the sum of the magnitudes of its terms (Shewchuk 1997, the
/// first bound of Orient3D): its operations are the same, with the roles of the four points changed.
const ROUNDING: f64 = (7.0 + 56.0 * UNIT) * UNIT;
/// Rounding unit, 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// The plane through three sites.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    sites: [Site; 3],
    /// Two-by-two minors of the sides from the first site.
    minors: [f64; 3],
    /// The same with all terms positive.
    magnitudes: [f64; 3],
}

impl Plane {
    /// The plane through three sites, oriented by their order.
    pub(crate) fn through(sites: [Site; 3]) -> Self {
        let [a, b, c] = &sites;
        let (u, v) = (minus(b.position, a.position), minus(c.position, a.position));
        let minor = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
        let magnitude = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        Self {
            sites,
            minors: [minor(1, 2), minor(2, 0), minor(0, 1)],
            magnitudes: [magnitude(1, 2), magnitude(2, 0), magnitude(0, 1)],
        }
    }

    /// The side on which a site lies: the answer of [`side_of_plane`], in double precision where its error bound
    /// allows.
    #[inline]
    pub(crate) fn side_of(&self, site: Site) -> Side {
        let away = minus(site.position, self.sites[0].position);
        let volume = away[0] * self.minors[0] + away[1] * self.minors[1] + away[2] * self.minors[2];
        let [x, y, z] = [away[0].abs(), away[1].abs(), away[2].abs()];
        let bound = ROUNDING * (x * self.magnitudes[0] + y * self.magnitudes[1] + z * self.magnitudes[2]);
        if volume > bound {
            Side::Above
        } else if volume < -bound {
            Side::Below
        } else {
            let [a, b, c] = self.sites;
            // All terms are zero, and none has underflowed: of faces that shrank to a point or a line nothing else is
            // left, and there are many of them at a time.
            if bound <= 0.0 { perturbed_side([a, b, c, site]) } else { side_of_plane(a, b, c, site) }
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn plane_side_of_points_and_lines_is_that_of_the_exact_predicate() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(6);
        for _ in 0..50_000 {
            // The smallest and the largest numbers that a frame takes, and few of them.
            let mut number =
                || [0.0, 2f64.powi(-250), 2f64.powi(-250) * 1.5, 1.0, 2f64.powi(250)][rng.random_range(0..5)];
            let mut point = || [number(), number(), number()];
            let positions = [point(), point(), point(), point()];
            let mut indices: [u32; 4] = std::array::from_fn(|k| 4 * u32::try_from(k).unwrap() + rng.random_range(0..4));
            indices.rotate_left(rng.random_range(0..4));
            let [a, b, c, d] = std::array::from_fn(|k| {
                // As often as not all in one place, or on a line.
                Site { position: positions[[k, 0, k % 2][rng.random_range(0..3)]], index: indices[k] }
            });
            assert_eq!(Plane::through([a, b, c]).side_of(d), side_of_plane(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
        }
    }

    #[test]
    fn plane_side_is_that_of_the_exact_predicate() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        for round in 0..200_000 {
            let mut point = || -> [f64; 3] { std::array::from_fn(|_| rng.random_range(-1.0..1.0)) };
            let corners = [point(), point(), point()];
            let mut last = point();
            if round % 2 == 0 {
                // In the plane but for rounding.
                let weights = point();
                let sum: f64 = weights.iter().sum();
                last = std::array::from_fn(|axis| {
                    (0..3).map(|corner| weights[corner] / sum * corners[corner][axis]).sum::<f64>()
                });
            }
            let site = |index: u32, position| Site { position, index };
            let [a, b, c] = [0, 1, 2].map(|corner| site(u32::try_from(corner).unwrap(), corners[corner]));
            let plane = Plane::through([a, b, c]);
            let exact = side_of_plane(a, b, c, site(3, last));
            assert_eq!(plane.side_of(site(3, last)), exact, "{corners:?} {last:?}");
        }
    }
}
