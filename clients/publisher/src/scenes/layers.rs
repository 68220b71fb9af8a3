//! Two sheets through each other.

use std::f64::consts::PI;

use crate::mesh::{Cloth, Vec3};

use super::sheet::{Pin, Sheet};

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

/// The end of a strip hangs through a taut sheet: BB/II. The strip is held at its other end and bows down, at constant
/// curvature and without stretch.
pub(super) fn tongue(seed: u64, edge_m: f64) -> Cloth {
    const LENGTH_M: f64 = 0.4;
    const WIDTH_M: f64 = 0.2;
    const HEIGHT_M: f64 = 0.08;
    const TURN: f64 = 0.9;
    let radius = LENGTH_M / TURN;
    let bow = |u: f64, v: f64| {
        let angle = u / radius;
        Vec3::new(radius * angle.sin(), v, HEIGHT_M - radius * (1.0 - angle.cos()))
    };
    let mut cloth = Sheet::new(SIDE_M, SIDE_M, edge_m).pinned(Pin::Boundary).build(seed, flat);
    let strip = Sheet::new(LENGTH_M, WIDTH_M, edge_m).pinned(Pin::Left).build(seed ^ 1, bow);
    cloth.append(strip, Vec3::new(0.063, 0.151, 0.0));
    cloth
}

/// Two strips hang side by side from pegs, overlap a little, and change places on the way down: BI/BI.
pub(super) fn curtains(seed: u64, edge_m: f64) -> Cloth {
    const LENGTH_M: f64 = 0.4;
    const WIDTH_M: f64 = 0.2;
    const OVERLAP_M: f64 = 0.07;
    const CROSSING_M: f64 = 0.15;
    let strip = |seed: u64, slope: f64| {
        let hang = |u: f64, v: f64| Vec3::new(u, slope * (v - CROSSING_M), v);
        Sheet::new(WIDTH_M, LENGTH_M, edge_m).pinned(Pin::Peg).build(seed, hang)
    };
    let mut cloth = strip(seed, -0.15);
    cloth.append(strip(seed ^ 1, 0.15), Vec3::new(WIDTH_M - OVERLAP_M, 0.001, 0.002));
    cloth
}
