//! Triangles with texture coordinates and positions, put together from grids.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use untangle::{
    analysis::{Analysis, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
};

/// One sheet, or several that were added one after the other.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Vertices of each face.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates of each vertex.
    pub uvs: Vec<[f64; 2]>,
    /// Position of each vertex in metres.
    pub positions: Vec<[f64; 3]>,
}

impl Sheet {
    /// A folded sheet `f(u, v) = (u^2, v, a tanh(u / a) g(u^2, v))`, whose layers `u` and `-u` meet where `g` vanishes.
    pub fn fold(domain_u: [f64; 2], cells: [u32; 2], g: impl Fn(f64, f64) -> f64) -> Self {
        let mut sheet = Self::default();
        sheet.add_grid(domain_u, [0.0, 1.0], cells, folded(g));
        sheet
    }

    /// Adds a grid over `[u0, u1] x [v0, v1]`, placed by `place`.
    pub fn add_grid(
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
    pub fn add_lines(&mut self, us: &[f64], vs: &[f64], place: impl Fn(f64, f64) -> [f64; 3]) {
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

    /// Keeps the faces for which `keep` holds, by the texture coordinates of their centroids.
    pub fn keep_faces(&mut self, keep: impl Fn([f64; 2]) -> bool) {
        let uvs = &self.uvs;
        self.faces.retain(|corners| {
            let sum = corners.iter().fold([0.0; 2], |[u, v], &corner| {
                let [cu, cv] = uvs[corner as usize];
                [u + cu, v + cv]
            });
            keep(sum.map(|sum| sum / 3.0))
        });
    }

    /// The mesh as a caller would describe it, with texture coordinates.
    pub fn description(&self) -> MeshDescription {
        let uvs = Uvs { coordinates: self.uvs.clone(), corners: self.faces.clone() };
        MeshDescription { uvs: Some(uvs), ..self.bare_description() }
    }

    /// The mesh as a caller would describe it, without texture coordinates.
    pub fn bare_description(&self) -> MeshDescription {
        MeshDescription { num_vertices: self.positions.len(), faces: self.faces.clone(), ..Default::default() }
    }

    /// The mesh with texture coordinates.
    pub fn mesh(&self) -> Mesh {
        Mesh::new(self.description()).unwrap()
    }

    /// The mesh without texture coordinates: discs are measured by the lengths of its edges.
    pub fn bare_mesh(&self) -> Mesh {
        Mesh::new(self.bare_description()).unwrap()
    }

    /// The positions as a frame of a mesh with these vertices.
    pub fn frame(&self, mesh: &Mesh) -> Frame {
        Frame::new(mesh, &self.positions).unwrap()
    }

    /// Mesh with texture coordinates, frame, and the analysis of both.
    pub fn analyse(&self) -> (Mesh, Frame, Analysis) {
        let mesh = self.mesh();
        let frame = self.frame(&mesh);
        let analysis = analyse(&mesh, &frame);
        (mesh, frame, analysis)
    }
}

/// Places a vertex of a folded sheet; see [`Sheet::fold`].
pub fn folded(g: impl Fn(f64, f64) -> f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |u, v| {
        let x = u * u;
        [x, v, 0.3 * (u / 0.3).tanh() * g(x, v)]
    }
}

/// Faces and texture coordinates of `resolution x resolution` squares over the unit square, with diagonals of random
/// direction.
pub fn squares(resolution: u32, rng: &mut ChaCha8Rng) -> (Vec<[u32; 3]>, Vec<[f64; 2]>) {
    let step = 1.0 / f64::from(resolution);
    let row = resolution + 1;
    let uvs = (0..row * row).map(|k| [f64::from(k % row) * step, f64::from(k / row) * step]).collect();
    let mut faces = Vec::new();
    for y in 0..resolution {
        for x in 0..resolution {
            let [a, b, c, d] = [y * row + x, y * row + x + 1, (y + 1) * row + x + 1, (y + 1) * row + x];
            faces.extend(if rng.random() { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    (faces, uvs)
}
