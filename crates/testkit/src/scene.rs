//! Scenes put together from grids, with their parameter domains.

use untangle::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
};

/// A scene with its parameter domain: one pair of parameters for each vertex.
#[derive(Clone, Default)]
pub(crate) struct Scene {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) uvs: Vec<[f64; 2]>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Scene {
    /// Adds a grid over `[u0, u1] x [v0, v1]`, placed by `place`.
    pub(crate) fn add_grid(
        &mut self,
        [u0, u1]: [f64; 2],
        [v0, v1]: [f64; 2],
        [nu, nv]: [u32; 2],
        place: impl Fn(f64, f64) -> [f64; 3],
    ) {
        let steps = |low: f64, high: f64, count: u32| -> Vec<f64> {
            (0..=count).map(|i| low + (high - low) * f64::from(i) / f64::from(count)).collect()
        };
        self.add_lines(&steps(u0, u1, nu), &steps(v0, v1, nv), place);
    }

    /// Adds a grid with columns at `us` and rows at `vs`; squares are split along their rising diagonals.
    pub(crate) fn add_lines(&mut self, us: &[f64], vs: &[f64], place: impl Fn(f64, f64) -> [f64; 3]) {
        let first = u32::try_from(self.positions.len()).unwrap();
        for &v in vs {
            for &u in us {
                self.uvs.push([u, v]);
                self.positions.push(place(u, v));
            }
        }
        let [nu, nv] = [us.len(), vs.len()].map(|count| u32::try_from(count).unwrap());
        for j in 1..nv {
            for i in 1..nu {
                let at = |di: u32, dj: u32| first + (j - dj) * nu + i - di;
                self.faces.push([at(1, 1), at(0, 1), at(0, 0)]);
                self.faces.push([at(1, 1), at(0, 0), at(1, 0)]);
            }
        }
    }

    /// A folded sheet `f(u, v) = (u^2, v, a tanh(u / a) g(u^2, v))`, whose layers `u` and `-u` meet where `g` vanishes.
    pub(crate) fn fold(domain_u: [f64; 2], cells: [u32; 2], g: impl Fn(f64, f64) -> f64) -> Self {
        let mut scene = Self::default();
        scene.add_grid(domain_u, [0.0, 1.0], cells, folded(g));
        scene
    }

    /// What a caller would hand over.
    pub(crate) fn description(&self) -> MeshDescription {
        let uvs = Uvs { coordinates: self.uvs.clone(), corners: self.faces.clone() };
        MeshDescription {
            num_vertices: self.positions.len(),
            faces: self.faces.clone(),
            uvs: Some(uvs),
            ..Default::default()
        }
    }

    pub(crate) fn analyse(&self) -> (Mesh, Frame, Analysis) {
        let mesh = Mesh::new(self.description()).unwrap();
        let frame = Frame::new(&mesh, &self.positions).unwrap();
        let analysis = analyse(&mesh, &frame);
        (mesh, frame, analysis)
    }

    /// The faces for which `keep` holds, by the parameters of their middle.
    pub(crate) fn keep_faces(&mut self, keep: impl Fn([f64; 2]) -> bool) {
        let uvs = &self.uvs;
        self.faces.retain(|corners| {
            let sum = corners.iter().fold([0.0; 2], |[u, v], &corner| {
                let [cu, cv] = uvs[corner as usize];
                [u + cu, v + cv]
            });
            keep(sum.map(|sum| sum / 3.0))
        });
    }
}

/// The placing of a folded sheet; see [`Scene::fold`].
pub(crate) fn folded(g: impl Fn(f64, f64) -> f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |u, v| {
        let x = u * u;
        [x, v, 0.3 * (u / 0.3).tanh() * g(x, v)]
    }
}
