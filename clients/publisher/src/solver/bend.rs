//! Hinges keep their angle: isometric bending (Bergou, Wardetzky, Harmon, Zorin and Grinspun 2006).
//!
//! With cotangent weights `k` the vector `L = sum k_i x_i` over the four vertices of a hinge vanishes when it is flat,
//! and has the length `2 |e| sin(angle / 2)` when it is bent; the energy is `3 B / (2 A) |L|^2`. Since `L` is linear in
//! the positions, `L` itself can serve as a constraint of three components with the same gradient in each, which one
//! multiplier solves exactly. A hinge that is bent at rest keeps the length of `L`, not its direction, so that a
//! rotation of the whole cloth has no energy.

use crate::mesh::{Cloth, Vec3};

#[derive(Clone, Debug)]
struct BentHinge {
    vertices: [u32; 4],
    weights: [f64; 4],
    /// |L| at rest, in metres.
    rest_m: f64,
    /// `A / (3 B)`.
    compliance: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Bend {
    hinges: Vec<BentHinge>,
}

impl Bend {
    /// Hinges with a triangle of (nearly) no area are left out, since their cotangents are not finite.
    pub(super) fn new(cloth: &Cloth, stiffness_n_m: f64) -> Self {
        let hinges = cloth
            .hinges()
            .into_iter()
            .filter_map(|hinge| {
                let x = hinge.vertices.map(|vertex| cloth.rest_positions[vertex as usize]);
                let (weights, area) = weights(x)?;
                let bent = weighted_sum(&weights, x);
                let rest_m = if cloth.flat_hinges { 0.0 } else { bent.norm() };
                let compliance = area / (3.0 * stiffness_n_m);
                Some(BentHinge { vertices: hinge.vertices, weights, rest_m, compliance })
            })
            .collect();
        Self { hinges }
    }

    pub(super) fn project(&self, positions: &mut [Vec3], inverse_masses: &[f64], substep_s: f64) {
        for hinge in &self.hinges {
            let vertices = hinge.vertices.map(|vertex| vertex as usize);
            let mut weight = 0.0;
            for (&vertex, k) in vertices.iter().zip(hinge.weights) {
                weight += inverse_masses[vertex] * k * k;
            }
            let bent = weighted_sum(&hinge.weights, vertices.map(|vertex| positions[vertex]));
            let length = bent.norm();
            if weight <= 0.0 || length <= 0.0 {
                continue;
            }
            let error = bent * (1.0 - hinge.rest_m / length);
            let multiplier = error / (weight + hinge.compliance / (substep_s * substep_s));
            for (&vertex, k) in vertices.iter().zip(hinge.weights) {
                positions[vertex] -= multiplier * (inverse_masses[vertex] * k);
            }
        }
    }
}

fn weighted_sum(weights: &[f64; 4], x: [Vec3; 4]) -> Vec3 {
    weights.iter().zip(x).map(|(&weight, x)| x * weight).sum()
}

/// The weights of the four vertices and the area of the two triangles; `None` where a triangle has (nearly) no area.
fn weights([a, b, c, d]: [Vec3; 4]) -> Option<([f64; 4], f64)> {
    let cotangent = |at: Vec3, p: Vec3, q: Vec3| {
        let (p, q) = (p - at, q - at);
        let sine = p.cross(&q).norm();
        (sine > 1e-6 * p.norm() * q.norm()).then(|| p.dot(&q) / sine)
    };
    let (a_c, a_d) = (cotangent(a, b, c)?, cotangent(a, b, d)?);
    let (b_c, b_d) = (cotangent(b, a, c)?, cotangent(b, a, d)?);
    let area = 0.5 * ((b - a).cross(&(c - a)).norm() + (b - a).cross(&(d - a)).norm());
    Some(([b_c + b_d, a_c + a_d, -(a_c + b_c), -(a_d + b_d)], area))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weighted_sum_of_a_hinge_is_zero_when_flat_and_of_known_length_when_bent() {
        let (a, b) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0));
        let flat = [a, b, Vec3::new(-1.0, 0.7, 0.0), Vec3::new(1.5, 1.2, 0.0)];
        let (k, _) = weights(flat).unwrap();
        assert!(weighted_sum(&k, flat).norm() < 1e-12);
        let angle: f64 = 0.8;
        let bent = [a, b, flat[2], Vec3::new(1.5 * angle.cos(), 1.2, 1.5 * angle.sin())];
        assert!((weighted_sum(&k, bent).norm() - 2.0 * 2.0 * (angle / 2.0).sin()).abs() < 1e-12);
    }
}
