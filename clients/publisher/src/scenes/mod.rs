//! Tangled scenes to start from, the same for the same seed: one for each type of intersection path in Wicke, Lanker
//! and Gross (2006), and several side by side.
//!
//! Each tangle is held: the cloth is pinned and gravity drives it further in, so that it stays tangled without
//! corrections. The rest shape of every sheet is flat, and its texture coordinates are the rest shape, in metres.

mod folds;
mod layers;
mod sheet;

use std::str::FromStr;

use thiserror::Error;

use crate::mesh::{Cloth, Vec3};

pub use sheet::{Pin, Sheet};

/// A scene by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// A slack sheet sags through a taut one: CLOSED/CLOSED.
    Bag,
    /// The end of a strip hangs through a taut sheet: BB/II.
    Tongue,
    /// Two strips hang side by side and change places where they overlap: BI/BI.
    Curtains,
    /// The layers of a folded sheet have changed places in the middle of the crease: LL.
    Crease,
    /// The layers of a folded sheet have changed places at one end of the crease: BLI.
    Twist,
    /// The layers have changed places in a drop that touches the crease in one vertex: EIGHT.
    Drop,
    /// The layers have changed places in a wedge that starts in one vertex of the crease: CROSS.
    Wedge,
    /// The scenes of the demonstration, side by side.
    Gallery,
}

/// A name of no scene.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("there is no scene `{0}`; there are bag, tongue, curtains, crease, twist, drop, wedge and gallery")]
pub struct UnknownScene(pub String);

impl FromStr for Scene {
    type Err = UnknownScene;

    fn from_str(name: &str) -> Result<Self, UnknownScene> {
        Ok(match name {
            "bag" => Self::Bag,
            "tongue" => Self::Tongue,
            "curtains" => Self::Curtains,
            "crease" => Self::Crease,
            "twist" => Self::Twist,
            "drop" => Self::Drop,
            "wedge" => Self::Wedge,
            "gallery" => Self::Gallery,
            _ => return Err(UnknownScene(name.into())),
        })
    }
}

impl Scene {
    /// The names of the scenes with one type of path each.
    pub const SINGLE: [&str; 7] = ["bag", "tongue", "curtains", "crease", "twist", "drop", "wedge"];

    /// Builds the scene with triangles of about `edge_m` metres.
    #[must_use]
    pub fn build(self, seed: u64, edge_m: f64) -> Cloth {
        match self {
            Self::Bag => layers::bag(seed, edge_m),
            Self::Tongue => layers::tongue(seed, edge_m),
            Self::Curtains => layers::curtains(seed, edge_m),
            Self::Crease => folds::crease(seed, edge_m),
            Self::Twist => folds::twist(seed, edge_m),
            Self::Drop => folds::drop(seed, edge_m),
            Self::Wedge => folds::wedge(seed, edge_m),
            Self::Gallery => gallery(seed, edge_m),
        }
    }
}

/// The scenes of the demonstration, in two rows, each with its place in metres.
const GALLERY: [(Scene, [f64; 2]); 7] = [
    (Scene::Bag, [0.0, 0.0]),
    (Scene::Tongue, [0.65, 0.0]),
    (Scene::Wedge, [1.3, 0.0]),
    (Scene::Crease, [0.0, 0.7]),
    (Scene::Curtains, [0.55, 0.9]),
    (Scene::Twist, [1.0, 0.7]),
    (Scene::Drop, [1.5, 0.7]),
];

fn gallery(seed: u64, edge_m: f64) -> Cloth {
    let mut cloth = Cloth::default();
    for (scene, [x, y]) in GALLERY {
        cloth.append(scene.build(seed, edge_m), Vec3::new(x, y, 0.0));
    }
    cloth
}

#[cfg(test)]
mod tests {
    use super::*;
    use untangled_checker::count_edge_face;

    #[test]
    fn build_of_every_scene_is_tangled_pinned_and_reproducible() {
        for name in Scene::SINGLE.into_iter().chain(["gallery"]) {
            let scene: Scene = name.parse().unwrap();
            let cloth = scene.build(3, 0.04);
            assert_eq!(scene.build(3, 0.04), cloth, "{name}");
            assert!(count_edge_face(&cloth.points(), &cloth.triangles).unwrap() > 5, "{name} is not tangled");
            assert!(!cloth.pins.is_empty(), "{name} is not held");
        }
        assert!("knot".parse::<Scene>().is_err());
    }
}
