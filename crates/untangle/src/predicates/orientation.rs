//! The orientation of four points, exact and perturbed.

use robust::Coord3D;

use super::{Side, Site, perturbation::perturbed_side};

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

fn coord3(site: Site) -> Coord3D<f64> {
    let [x, y, z] = site.position;
    Coord3D { x, y, z }
}
