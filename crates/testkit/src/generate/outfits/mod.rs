//! Outfits of layers on a body with arms and legs, in poses.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};
use untangle::mesh::MeshDescription;

use super::Sheet;

/// How a body stands: angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Of both arms, from straight down outwards.
    pub arms: [f64; 2],
    /// Of both legs, from straight down outwards.
    pub legs: [f64; 2],
}

impl Pose {
    /// Ten poses: arms down, so that sleeves lie against the torso, up to overhead; legs that nearly touch, up to far
    /// apart.
    pub const ALL: [Self; 10] = [
        Self::new([0.6, 0.6], [0.1, 0.1]),
        Self::new([1.5, 0.8], [0.3, 0.05]),
        Self::new([1.1, 0.4], [0.2, 0.0]),
        Self::new([0.45, 0.45], [0.0, 0.0]),
        Self::new([1.57, 1.57], [0.4, 0.4]),
        Self::new([2.4, 2.4], [0.1, 0.1]),
        Self::new([2.8, 0.5], [0.0, 0.3]),
        Self::new([0.5, 2.0], [0.5, -0.03]),
        Self::new([0.5, 1.0], [-0.04, -0.02]),
        Self::new([0.8, 0.8], [0.8, 0.8]),
    ];

    const fn new(arms: [f64; 2], legs: [f64; 2]) -> Self {
        Self { arms, legs }
    }
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

/// A body whose parts overlap at shoulders and hips, and a shirt, trousers, a jacket and a belt on it.
#[derive(Clone, Debug)]
pub struct Outfit {
    /// The body.
    pub body: Sheet,
    /// Garments from the body outwards. Their faces point outwards.
    pub layers: [Sheet; 4],
}

/// The names of the garments.
pub const GARMENTS: [&str; 4] = ["shirt", "trousers", "jacket", "belt"];

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
    /// An outfit whose torso tubes have so many vertices around. The jacket's folds go through the shirt and the belt.
    #[must_use]
    pub fn new(pose: Pose, around: u32) -> Self {
        Self::cut_for(pose, pose, around)
    }

    /// The same with garments that were cut for another pose: of the same faces in all poses. They have no holes for
    /// arms, so that those of the torso begin below the armpits.
    #[must_use]
    pub fn cut_for(cut: Pose, pose: Pose, around: u32) -> Self {
        let below_armpits = cut.arms.map(|angle| 0.2 * angle.cos() / angle.sin());
        let top = below_armpits.into_iter().fold(0.1, f64::max);
        let [arms, legs] = [
            [Limb::arm(-1.0, pose.arms[0]), Limb::arm(1.0, pose.arms[1])],
            [Limb::leg(-1.0, pose.legs[0]), Limb::leg(1.0, pose.legs[1])],
        ];
        let mut body = Sheet::default();
        TORSO.add_body(&mut body, around);
        arms.iter().chain(&legs).for_each(|limb| limb.add_body(&mut body, around / 2));
        let [mut shirt, mut trousers, mut jacket, mut belt] = [(); 4].map(|()| Sheet::default());
        TORSO.add_tube(&mut shirt, [top, 0.85], 0.03, [0.02, 2.0], around);
        arms.iter().for_each(|arm| arm.add_tube(&mut shirt, [0.45, 0.8], 0.02, [0.01, 4.0], around / 2));
        legs.iter().for_each(|leg| leg.add_tube(&mut trousers, [0.55, 1.05], 0.02, [0.01, 4.0], around / 2));
        TORSO.add_tube(&mut jacket, [top + 0.02, 0.8], 0.06, [0.035, 3.0], around + 5);
        arms.iter().for_each(|arm| arm.add_tube(&mut jacket, [0.47, 0.78], 0.04, [0.025, 3.0], around / 2 + 3));
        TORSO.add_tube(&mut belt, [0.6, 0.68], 0.085, [0.01, 2.0], around + 9);
        Self { body, layers: [shirt, trousers, jacket, belt] }
    }

    /// All garments, then the body, as one mesh in layers, with its positions.
    #[must_use]
    pub fn world(&self) -> (MeshDescription, Vec<[f64; 3]>) {
        let (mut positions, mut faces, mut layers) = (Vec::new(), Vec::new(), Vec::new());
        let mut num_cloth = 0;
        for (number, sheet) in (0..).zip(self.layers.iter().chain([&self.body])) {
            num_cloth = u32::try_from(positions.len()).expect("a small mesh");
            faces.extend(sheet.faces.iter().map(|face| face.map(|corner| corner + num_cloth)));
            positions.extend_from_slice(&sheet.positions);
            layers.resize(positions.len(), number);
        }
        let num_vertices = positions.len();
        let body = (num_cloth..u32::try_from(num_vertices).expect("a small mesh")).collect();
        let description = MeshDescription { num_vertices, faces, layers: Some(layers), body, ..Default::default() };
        (description, positions)
    }
}
