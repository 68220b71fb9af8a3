//! Outfits of layers on a body with arms and legs, in poses.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};

use super::Sheet;

/// How a body stands: angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Of both arms, from straight down outwards.
    pub arms: [f64; 2],
    /// Of both legs, from straight down outwards.
    pub legs: [f64; 2],
}

/// A limb, or the torso: a capsule from a joint along a direction.
#[derive(Clone, Copy, Debug)]
struct Limb {
    joint: Vector3<f64>,
    /// From straight down, in the plane of the first and third axis; positive towards the first.
    angle: f64,
    length: f64,
    radius: f64,
}

/// A body whose parts overlap at shoulders and hips, and a shirt, trousers and a jacket on it.
#[derive(Clone, Debug)]
pub struct Outfit {
    /// The body.
    pub body: Sheet,
    /// Garments from the body outwards. Their faces point outwards.
    pub layers: [Sheet; 3],
}

const TORSO: Limb = Limb { joint: Vector3::new(0.0, 0.0, 0.45), angle: 0.0, length: 0.9, radius: 0.3 };

impl Limb {
    fn arm(side: f64, angle: f64) -> Self {
        Self { joint: Vector3::new(0.26 * side, 0.0, 0.45), angle: side * angle, length: 0.85, radius: 0.09 }
    }

    fn leg(side: f64, angle: f64) -> Self {
        Self { joint: Vector3::new(0.2 * side, 0.0, -0.5), angle: side * angle, length: 1.1, radius: 0.12 }
    }

    /// Places what was made round the third axis, where the joint is the origin and the limb goes down.
    fn place(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), -self.angle);
        (self.joint + turn * Vector3::new(x, y, z)).into()
    }

    fn add_body(self, sheet: &mut Sheet, around: u32) {
        let first = sheet.positions.len();
        sheet.add_capsule(self.radius, 0.5 * self.length, 2 * around, around);
        for place in &mut sheet.positions[first..] {
            *place = self.place([place[0], place[1], place[2] - 0.5 * self.length]);
        }
    }

    /// Adds a tube round the limb between two distances from its joint, `off` its surface, with folds: their depth and
    /// number.
    fn add_tube(self, sheet: &mut Sheet, [from, to]: [f64; 2], off: f64, [fold, waves]: [f64; 2], around: u32) {
        let first = sheet.positions.len();
        let edge = TAU * (self.radius + off) / f64::from(around);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let rows = ((to - from) / edge).ceil() as u32;
        sheet.add_tube(self.radius + off, [-to, -from], [around, rows], |angle, height| {
            let out = fold * (waves * angle + 20.0 * height).sin();
            [out * angle.cos(), out * angle.sin(), 0.0]
        });
        for place in &mut sheet.positions[first..] {
            *place = self.place(*place);
        }
    }
}

impl Outfit {
    /// An outfit whose torso tubes have so many vertices around. The jacket's folds go through the shirt.
    #[must_use]
    pub fn new(pose: Pose, around: u32) -> Self {
        let [arms, legs] = [
            [Limb::arm(-1.0, pose.arms[0]), Limb::arm(1.0, pose.arms[1])],
            [Limb::leg(-1.0, pose.legs[0]), Limb::leg(1.0, pose.legs[1])],
        ];
        let mut body = Sheet::default();
        TORSO.add_body(&mut body, around);
        arms.iter().chain(&legs).for_each(|limb| limb.add_body(&mut body, around / 2));
        let [mut shirt, mut trousers, mut jacket] = [Sheet::default(), Sheet::default(), Sheet::default()];
        TORSO.add_tube(&mut shirt, [0.1, 0.85], 0.03, [0.02, 2.0], around);
        arms.iter().for_each(|arm| arm.add_tube(&mut shirt, [0.45, 0.8], 0.02, [0.01, 4.0], around / 2));
        legs.iter().for_each(|leg| leg.add_tube(&mut trousers, [0.55, 1.05], 0.02, [0.01, 4.0], around / 2));
        TORSO.add_tube(&mut jacket, [0.12, 0.8], 0.06, [0.035, 3.0], around + 5);
        arms.iter().for_each(|arm| arm.add_tube(&mut jacket, [0.47, 0.78], 0.04, [0.025, 3.0], around / 2 + 3));
        Self { body, layers: [shirt, trousers, jacket] }
    }
}
