//! One generated scene for each type of intersection path.
//!
//! Folded sheets are `f(u, v) = (u^2, v, a tanh(u / a) g(u^2, v))`: the layers `u` and `-u` meet exactly where `g = 0`,
//! and the sheet meets itself in a loop vertex where that curve reaches the crease `u = 0`. The other scenes are two
//! sheets placed through each other.

use std::{collections::BTreeMap, error::Error};

use untangle::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    paths::PairType,
};

/// A scene, where it is seen from, and what it is to show.
pub(crate) struct Scene {
    /// The pair that the analysis must find.
    pub(crate) pair_type: PairType,
    /// Azimuth and elevation of the viewer in radians.
    pub(crate) seen_from: [f64; 2],
    positions: Vec<[f64; 3]>,
    /// Parameters of each vertex; those of the second sheet lie beside those of the first.
    pub(crate) domain: Vec<[f64; 2]>,
    faces: Vec<[u32; 3]>,
}

/// Mesh, positions and analysis of a scene.
pub(crate) type Analysed = (Mesh, Frame, Analysis);

impl Scene {
    fn new(pair_type: PairType, seen_from: [f64; 2]) -> Self {
        Self { pair_type, seen_from, positions: Vec::new(), domain: Vec::new(), faces: Vec::new() }
    }

    /// Analyses the scene as a user would.
    pub(crate) fn analyse(&self) -> Result<Analysed, Box<dyn Error>> {
        let mesh = Mesh::new(MeshDescription {
            num_vertices: self.positions.len(),
            faces: self.faces.clone(),
            uvs: Some(Uvs { coordinates: self.domain.clone(), corners: self.faces.clone() }),
            ..MeshDescription::default()
        })?;
        let frame = Frame::new(&mesh, &self.positions)?;
        let analysis = analyse(&mesh, &frame);
        Ok((mesh, frame, analysis))
    }

    /// Adds a sheet over `[u0, u1] x [v0, v1]`, placed by `place`, to the right of what is in the parameter domain.
    fn sheet(
        mut self,
        u: [f64; 2],
        v: [f64; 2],
        [nu, nv]: [u32; 2],
        place: impl Fn(f64, f64) -> [f64; 3],
    ) -> Result<Self, Box<dyn Error>> {
        const GAP: f64 = 0.15;
        let rightmost = self.domain.iter().map(|&[u, _]| u).reduce(f64::max);
        let shift = rightmost.map_or(0.0, |right| right + GAP - u[0]);
        let first = u32::try_from(self.positions.len())?;
        let step = |[low, high]: [f64; 2], k: u32, count: u32| low + (high - low) * f64::from(k) / f64::from(count);
        for j in 0..=nv {
            for i in 0..=nu {
                let (u, v) = (step(u, i, nu), step(v, j, nv));
                self.domain.push([u + shift, v]);
                self.positions.push(place(u, v));
            }
        }
        for j in 0..nv {
            for i in 0..nu {
                let corner = |di: u32, dj: u32| first + (j + dj) * (nu + 1) + i + di;
                self.faces.push([corner(0, 0), corner(1, 0), corner(1, 1)]);
                self.faces.push([corner(0, 0), corner(1, 1), corner(0, 1)]);
            }
        }
        Ok(self)
    }

    /// A folded sheet whose layers meet where `g` vanishes.
    fn fold(self, u: [f64; 2], cells: [u32; 2], g: impl Fn(f64, f64) -> f64) -> Result<Self, Box<dyn Error>> {
        self.sheet(u, [0.0, 1.0], cells, |u, v| [u * u, v, 0.3 * (u / 0.3).tanh() * g(u * u, v)])
    }

    /// Slits a folded sheet of `nu` columns open along a row, from `u = 0.25` to its boundary: the lips touch exactly.
    fn slit(mut self, nu: u32, row: u32) -> Result<Self, Box<dyn Error>> {
        let on_slit = |vertex: u32| vertex / (nu + 1) == row && self.domain[vertex as usize][0] > 0.25;
        let num_vertices = u32::try_from(self.positions.len())?;
        let originals: Vec<u32> = (0..num_vertices).filter(|&vertex| on_slit(vertex)).skip(1).collect();
        let twins: BTreeMap<u32, u32> = originals.iter().copied().zip(num_vertices..).collect();
        for corners in self.faces.iter_mut().skip((row * 2 * nu) as usize) {
            corners.iter_mut().for_each(|corner| *corner = twins.get(corner).copied().unwrap_or(*corner));
        }
        for vertex in originals {
            self.positions.push(self.positions[vertex as usize]);
            self.domain.push(self.domain[vertex as usize]);
        }
        Ok(self)
    }
}

/// All scenes, in the order of the manual.
pub(crate) fn all() -> Result<Vec<Scene>, Box<dyn Error>> {
    let fold = |pair_type| Scene::new(pair_type, FOLD_SEEN_FROM);
    let ellipse =
        |x: f64, v: f64, middle: f64, half: f64| 0.3 * ((x / 0.5).powi(2) + ((v - middle) / half).powi(2) - 1.0);
    let rising = |x: f64, v: f64| v - 0.4 - 0.2 * x;
    Ok(vec![
        bump()?,
        upright(PairType::BoundaryBoundaryInsideInside, [-0.5, 0.4])?,
        upright(PairType::BoundaryInside, [0.4, 1.6])?,
        fold(PairType::LoopLoop).fold([-1.0, 0.97], [40, 31], |x, v| ellipse(x, v, 0.5, 0.3))?,
        fold(PairType::BoundaryLoopInside).fold([-1.0, 0.8], [40, 31], rising)?,
        fold(PairType::Eight).fold([-1.0, 1.0], [36, 36], |x, v| (v - 0.5).powi(2) - x * x * (0.6 - x))?,
        fold(PairType::Cross).fold([-1.0, 0.9], [38, 36], |x, v| (v - 0.5).powi(2) - 0.09 * x * x)?,
        fold(PairType::BoundaryLoopBoundary).fold([-0.75, 0.75], [36, 31], rising)?,
        fold(PairType::BoundaryLoopLoopBoundary)
            .fold([-1.0, 0.97], [40, 30], |x, v| ellipse(x, v, 0.47, 0.18))?
            .slit(40, 14)?,
        touching(PairType::BoundaryBoundaryBoundaryInside, -0.5, 12)?,
        touching(PairType::BoundaryBoundaryBoundaryBoundary, -1.0, 16)?,
    ])
}

const FOLD_SEEN_FROM: [f64; 2] = [-0.45, 0.65];

/// A level sheet, and one under it whose bump comes through.
fn bump() -> Result<Scene, Box<dyn Error>> {
    Scene::new(PairType::Closed, [-0.45, 0.45])
        .sheet([-1.0, 1.0], [-1.0, 1.0], [31, 29], |x, y| [x, y, 0.01 * x])?
        .sheet([-0.9, 0.93], [-0.91, 0.9], [30, 32], |x, y| [x, y, 0.75 * (-(x * x + y * y) / 0.12).exp() - 0.35])
}

/// A level sheet, and an upright one through it.
fn upright(pair_type: PairType, x: [f64; 2]) -> Result<Scene, Box<dyn Error>> {
    Scene::new(pair_type, [-0.45, 0.16]).sheet([-1.0, 1.0], [-1.0, 1.0], [29, 27], |x, y| [x, y, 0.013 * x * y])?.sheet(
        x,
        [-0.4, 0.9],
        [16, 19],
        |x, z| [x, 0.07 * x + 0.03 * z, z],
    )
}

/// A coarse strip that stands with its end through a level sheet: few enough vertices to see the target of each.
pub(crate) fn coarse_strip() -> Result<Scene, Box<dyn Error>> {
    Scene::new(PairType::BoundaryBoundaryInsideInside, [-1.0, -0.25])
        .sheet([-1.0, 1.0], [-1.0, 1.0], [13, 12], |x, y| [x, y, 0.013 * x * y])?
        .sheet([-0.5, 0.5], [-0.45, 0.6], [4, 7], |x, z| [x, 0.07 * x + 0.2 * z, z])
}

/// A level sheet and an upright one whose boundaries meet exactly in (1, 0.25, 0), in numbers that are exact in binary.
fn touching(pair_type: PairType, left: f64, cells: u32) -> Result<Scene, Box<dyn Error>> {
    Scene::new(pair_type, [-0.45, 0.25]).sheet([-1.0, 1.0], [-1.0, 1.0], [16, 16], |x, y| [x, y, 0.0])?.sheet(
        [left, 1.0],
        [-0.4375, 0.8125],
        [cells, 10],
        |x, z| [x, 0.25 * x + 0.125 * z, z],
    )
}
