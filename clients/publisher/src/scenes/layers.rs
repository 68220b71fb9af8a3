//! Two sheets through each other.

use std::f64::consts::PI;

use crate::mesh::{Cloth, Vec3};

use super::{Pin, Sheet};

/// Side of the sheet below, in metres.
const SIDE_M: f64 = 0.5;

fn flat(u: f64, v: f64) -> Vec3 {
    Vec3::new(u, v, 0.0)
}

/// A slack sheet, held all round above a taut one, sags through it: CLOSED/CLOSED.
pub(super) fn bag(seed: u64, edge_m: f64) -> Cloth {
    const FRAME_M: f64 = 0.38;
    const SLACK: f64 = 1.06;
    const HEIGHT_M: f64 = 0.04;
    const DEPTH_M: f64 = 0.11;
    let mut cloth = Sheet::new(SIDE_M, SIDE_M, edge_m).pinned(Pin::Boundary).build(seed, flat);
    let side = FRAME_M * SLACK;
    let sag = |u: f64, v: f64| {
        let dip = (PI * u / side).sin().powi(2) * (PI * v / side).sin().powi(2);
        Vec3::new(u / SLACK, v / SLACK, HEIGHT_M - DEPTH_M * dip)
    };
    let upper = Sheet::new(side, side, edge_m).pinned(Pin::Boundary).build(seed ^ 1, sag);
    let margin = 0.5 * (SIDE_M - FRAME_M);
    cloth.append(upper, Vec3::new(margin + 0.003, margin - 0.004, 0.0));
    cloth
}

/// A strip held at one end bows down, at constant curvature and without stretch.
fn bowed_strip(seed: u64, edge_m: f64, [length, width]: [f64; 2]) -> Cloth {
    const HEIGHT_M: f64 = 0.08;
    const TURN: f64 = 0.9;
    let radius = length / TURN;
    let bow = |u: f64, v: f64| {
        let angle = u / radius;
        Vec3::new(radius * angle.sin(), v, HEIGHT_M - radius * (1.0 - angle.cos()))
    };
    Sheet::new(length, width, edge_m).pinned(Pin::Left).build(seed, bow)
}

/// The end of a strip hangs through a taut sheet: BB/II.
pub(super) fn tongue(seed: u64, edge_m: f64) -> Cloth {
    let mut cloth = Sheet::new(SIDE_M, SIDE_M, edge_m).pinned(Pin::Boundary).build(seed, flat);
    cloth.append(bowed_strip(seed ^ 1, edge_m, [0.4, 0.2]), Vec3::new(0.063, 0.151, 0.0));
    cloth
}

/// A strip hangs through the free edge of a sheet: BI/BI.
pub(super) fn corner(seed: u64, edge_m: f64) -> Cloth {
    let mut cloth = Sheet::new(SIDE_M, 0.36, edge_m).pinned(Pin::AllButTop).build(seed, flat);
    cloth.append(bowed_strip(seed ^ 1, edge_m, [0.4, 0.2]), Vec3::new(0.063, 0.254, 0.0));
    cloth
}
