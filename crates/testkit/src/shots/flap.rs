//! A folded cloth that swings over a moving ball: its layers pass through each other, and the ball through the cloth,
//! in a few runs of frames.

use std::f64::consts::{PI, TAU};

use crate::generate::Sheet;

/// A run of frames in which something intersects.
#[derive(Clone, Copy, Debug)]
pub struct Tangle {
    /// The frame in its middle.
    pub middle: f64,
    /// Frames on both sides of it in which the motion that leads there is not zero.
    pub half_length: f64,
    /// How far the layers are pushed, as a part of their distance; beyond 1 they intersect.
    pub depth: f64,
    /// Where, in the coordinates of the cloth.
    pub place: [f64; 2],
}

/// The shot.
#[derive(Clone, Debug)]
pub struct FlapShot {
    /// Frames.
    pub num_frames: u32,
    /// Squares of the cloth along and across the fold.
    pub cells: [u32; 2],
    /// Where layers pass through each other.
    pub tangles: Vec<Tangle>,
    /// The frame in the middle of which the ball is highest, in the cloth; it never is where there is none.
    pub ball_middle: Option<f64>,
}

/// Radius of a pushed place.
const RADIUS: f64 = 0.2;
/// Radius of the ball.
const BALL: f64 = 0.15;
/// How far the ball is below the cloth, and how far it rises.
const BELOW: f64 = 0.06;
const RISE: f64 = 0.085;
/// Frames on both sides in which it rises and sinks.
const RISE_FRAMES: f64 = 16.0;

impl FlapShot {
    /// 24 frames of 480 triangles, tangled in the middle, clean at both ends.
    pub fn small() -> Self {
        let tangle = Tangle { middle: 11.5, half_length: 5.0, depth: 1.5, place: [0.55, 0.5] };
        Self { num_frames: 24, cells: [24, 10], tangles: vec![tangle], ball_middle: None }
    }

    /// 240 frames of 8,000 triangles, some thirty of them tangled.
    pub fn large() -> Self {
        let tangle = |middle, half_length, depth, place| Tangle { middle, half_length, depth, place };
        let tangles = vec![
            tangle(60.0, 12.0, 1.2, [0.5, 0.35]),
            tangle(120.0, 9.0, 1.3, [0.7, 0.65]),
            tangle(131.0, 9.0, 1.15, [0.45, 0.4]),
        ];
        Self { num_frames: 240, cells: [80, 50], tangles, ball_middle: Some(190.0) }
    }

    /// The cloth of a frame.
    pub fn cloth(&self, frame: u32) -> Sheet {
        let time = f64::from(frame);
        let gap = |x: f64, v: f64| {
            let push = |tangle: &Tangle| {
                let [dx, dv] = [x - tangle.place[0], v - tangle.place[1]];
                let near = bump((dx * dx + dv * dv).sqrt() / RADIUS);
                tangle.depth * near * bump((time - tangle.middle) / tangle.half_length)
            };
            let room = 0.3 + 0.03 * (9.0 * v + 0.11 * time).sin();
            room * (1.0 - self.tangles.iter().map(push).sum::<f64>())
        };
        let mut sheet = Sheet::fold([-1.0, 1.0], self.cells, gap);
        for position in &mut sheet.positions {
            *position = moved(*position, time);
        }
        sheet
    }

    /// The ball of a frame.
    pub fn ball(&self, frame: u32) -> Sheet {
        let time = f64::from(frame);
        let rise = self.ball_middle.map_or(0.0, |middle| RISE * bump((time - middle) / RISE_FRAMES));
        let mut sheet = Sheet::default();
        // Below the lower layer where that lies lowest.
        sheet.add_ball([0.5, 0.5, -0.1 - BALL - BELOW + rise], BALL, 12);
        for position in &mut sheet.positions {
            *position = moved(*position, time);
        }
        sheet
    }
}

/// A smooth bump of height 1 over -1 to 1.
fn bump(at: f64) -> f64 {
    let inside = (1.0 - at * at).max(0.0);
    inside * inside * inside
}

/// The motion of the whole: a wave along the cloth, and a swing.
fn moved([x, y, z]: [f64; 3], time: f64) -> [f64; 3] {
    let wave = 0.04 * (TAU * (0.8 * x - time / 60.0)).sin();
    let angle = 0.25 * PI * (TAU * time / 160.0).sin();
    let (sin, cos) = angle.sin_cos();
    let z = z + wave;
    [cos * x - sin * z + 0.002 * time, y, sin * x + cos * z]
}
