//! One folded sheet whose layers have passed through each other in a part of the fold.
//!
//! The surface is `f(u, v) = (phi(u), v, a tanh(u / e) g(phi(u), v))` with an even `phi`: the layers `u` and `-u` meet
//! exactly where `g` is zero, and where that curve reaches the crease `u = 0` there is a loop vertex. So the shape of
//! the curve `g = 0` in the half-plane `phi >= 0` is the type of the path. Where `g > 0` the layer `u > 0` is on top,
//! as gravity wants it. The lower layer is pinned at its three outer sides and is a little longer, so that a curve that
//! leaves the upper layer over its boundary ends inside of the lower one.

use crate::mesh::{Cloth, Vec3};

use super::sheet::{Pin, Sheet};

const LOWER_M: f64 = 0.3;
const WIDTH_M: f64 = 0.5;
/// Half the distance of the layers, in metres.
const GAP_M: f64 = 0.03;

fn fold(seed: u64, edge_m: f64, upper_m: f64, g: impl Fn(f64, f64) -> f64) -> Cloth {
    let roundness = edge_m;
    let map = |u: f64, v: f64| {
        let (u, v) = (u - LOWER_M, v - 0.5 * WIDTH_M);
        let phi = (u * u + roundness * roundness).sqrt() - roundness;
        Vec3::new(LOWER_M - phi, v + 0.5 * WIDTH_M, GAP_M * (u / (1.5 * roundness)).tanh() * g(phi, v))
    };
    Sheet::new(LOWER_M + upper_m, WIDTH_M, edge_m)
        .with_middle()
        .pinned(Pin::UpTo(LOWER_M - 2.0 * edge_m))
        .build(seed, map)
}

/// Changed places in the middle of the crease: a half ellipse from crease to crease, LL.
pub(super) fn crease(seed: u64, edge_m: f64) -> Cloth {
    fold(seed, edge_m, 0.24, |phi, v| 1.0 - 2.2 * (-(phi / 0.12).powi(2) - (v / 0.12).powi(2)).exp())
}

/// Changed places at one end of the crease: a curve from the crease over the edge of the upper layer, BLI.
pub(super) fn twist(seed: u64, edge_m: f64) -> Cloth {
    fold(seed, edge_m, 0.2, |phi, v| ((v + 0.1 + 0.2 * phi) / 0.08).tanh())
}

/// Changed places in a drop with its tip on the crease: a curve from a vertex back to it, EIGHT.
pub(super) fn drop(seed: u64, edge_m: f64) -> Cloth {
    fold(seed, edge_m, LOWER_M, |phi, v| ((v.powi(2) - phi.powi(2) * (1.0 - phi / 0.2)) / 0.01).tanh())
}

/// Changed places in a wedge with its tip on the crease: two curves from a vertex over the edge, CROSS.
pub(super) fn wedge(seed: u64, edge_m: f64) -> Cloth {
    fold(seed, edge_m, LOWER_M, |phi, v| ((v.powi(2) - (0.9 * phi).powi(2)) / 0.01).tanh())
}
