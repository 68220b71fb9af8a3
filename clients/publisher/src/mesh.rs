//! The cloth of this host: triangles, positions and rest shape.

use nalgebra::Vector3;

/// A point or a vector in space, in metres.
pub type Vec3 = Vector3<f64>;

/// One or several pieces of cloth in one world. Lengths in metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloth {
    /// Where the vertices are, `num_vertices x 3`.
    pub positions: Vec<Vec3>,
    /// Where they are at rest, without any force, `num_vertices x 3`. Only lengths and angles within a triangle and its
    /// neighbours are used, so a flat layout suffices.
    pub rest_positions: Vec<Vec3>,
    /// Vertex indices, `num_triangles x 3`.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates with indices of their own, if there are any.
    pub uvs: Option<Uvs>,
    /// Vertices that no force moves.
    pub pins: Vec<u32>,
    /// Whether hinges are flat at rest (generated scenes), or have the angle of the rest shape (files).
    pub flat_hinges: bool,
}

/// Texture coordinates, indexed by corners of triangles, not by vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uvs {
    /// `num_coordinates x 2`.
    pub coordinates: Vec<[f64; 2]>,
    /// For each triangle the coordinate index of its three corners, `num_triangles x 3`.
    pub corners: Vec<[u32; 3]>,
}

/// Two triangles at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hinge {
    /// The two vertices of the edge, then the vertex opposite in each triangle.
    pub vertices: [u32; 4],
}

impl Cloth {
    /// Every edge once, the lower vertex first, ascending.
    #[must_use]
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<_> = sides(&self.triangles).map(|(edge, _)| edge).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Every edge of exactly two triangles, ascending. An edge of more triangles has no bending stiffness.
    #[must_use]
    pub fn hinges(&self) -> Vec<Hinge> {
        let mut sides: Vec<_> = sides(&self.triangles).collect();
        sides.sort_unstable();
        sides
            .chunk_by(|(a, _), (b, _)| a == b)
            .filter_map(|group| match group {
                &[(edge, c), (_, d)] if c != d => Some(Hinge { vertices: [edge[0], edge[1], c, d] }),
                _ => None,
            })
            .collect()
    }

    /// Mass of each vertex in kilograms: a third of the rest area of its triangles times the density. A vertex of no
    /// triangle gets the mass of the lightest other one, since a mass can't be zero.
    #[must_use]
    pub fn masses_kg(&self, density_kg_m2: f64) -> Vec<f64> {
        let mut masses = vec![0.0; self.positions.len()];
        for &triangle in &self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.rest_positions[vertex as usize]);
            let share = 0.5 * (b - a).cross(&(c - a)).norm() * density_kg_m2 / 3.0;
            for vertex in triangle {
                masses[vertex as usize] += share;
            }
        }
        let lightest = masses.iter().copied().filter(|&mass| mass > 0.0).fold(f64::INFINITY, f64::min);
        let fallback = if lightest.is_finite() { lightest } else { 1.0 };
        for mass in &mut masses {
            if *mass <= 0.0 {
                *mass = fallback;
            }
        }
        masses
    }

    /// Mean length of the edges at rest, in metres; zero without edges.
    #[must_use]
    pub fn mean_edge_length_m(&self) -> f64 {
        let edges = self.edges();
        let total: f64 = edges.iter().map(|&edge| self.rest_length(edge)).sum();
        #[expect(clippy::cast_precision_loss, reason = "a count of edges is far below 2^53")]
        let count = edges.len().max(1) as f64;
        total / count
    }

    /// Length of an edge at rest, in metres.
    #[must_use]
    pub fn rest_length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.rest_positions[a as usize] - self.rest_positions[b as usize]).norm()
    }

    /// The ratio of an edge's length to its length at rest that is farthest from 1; 1 without edges.
    #[must_use]
    pub fn worst_edge_ratio(&self) -> f64 {
        let ratio = |[a, b]: [u32; 2]| {
            (self.positions[a as usize] - self.positions[b as usize]).norm() / self.rest_length([a, b])
        };
        let farther = |worst: f64, ratio: f64| if ratio.ln().abs() > worst.ln().abs() { ratio } else { worst };
        self.edges().into_iter().map(ratio).fold(1.0, farther)
    }

    /// Rounds every position to single precision, as the wire carries it, so that the host simulates the state that it
    /// publishes.
    pub fn round_to_f32(&mut self) {
        for position in &mut self.positions {
            *position = position.map(|value| f64::from(to_f32(value)));
        }
    }

    /// Adds the pieces of `other`, moved by `offset`.
    pub fn append(&mut self, other: Self, offset: Vec3) {
        let shift = |base: usize| move |index: u32| index + u32::try_from(base).unwrap_or(u32::MAX);
        let by_vertex = shift(self.positions.len());
        self.flat_hinges = other.flat_hinges && (self.positions.is_empty() || self.flat_hinges);
        if let Some(more) = other.uvs {
            let uvs = self.uvs.get_or_insert_with(Uvs::default);
            let by_coordinate = shift(uvs.coordinates.len());
            uvs.coordinates.extend(more.coordinates);
            uvs.corners.extend(more.corners.into_iter().map(|corners| corners.map(by_coordinate)));
        }
        self.positions.extend(other.positions.into_iter().map(|position| position + offset));
        self.rest_positions.extend(other.rest_positions);
        self.triangles.extend(other.triangles.into_iter().map(|triangle| triangle.map(by_vertex)));
        self.pins.extend(other.pins.into_iter().map(by_vertex));
    }

    /// Where the vertices are, `num_vertices x 3`, as the exact check and files want them.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 3]> {
        self.positions.iter().map(|&position| position.into()).collect()
    }
}

/// The sides of all triangles: the edge, lower vertex first, and the vertex opposite.
fn sides(triangles: &[[u32; 3]]) -> impl Iterator<Item = ([u32; 2], u32)> {
    triangles.iter().flat_map(|&[a, b, c]| {
        [(a, b, c), (b, c, a), (c, a, b)]
            .into_iter()
            .filter(|(p, q, _)| p != q)
            .map(|(p, q, opposite)| ([p.min(q), p.max(q)], opposite))
    })
}

/// The nearest single-precision number.
#[must_use]
pub fn to_f32(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "the wire carries single precision")]
    let rounded = value as f32;
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Cloth {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        Cloth {
            positions: corners.to_vec(),
            rest_positions: corners.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Cloth::default()
        }
    }

    #[test]
    fn edges_and_hinges_of_a_square_are_five_and_one() {
        assert_eq!(square().edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        assert_eq!(square().hinges(), [Hinge { vertices: [0, 2, 1, 3] }]);
    }

    #[test]
    fn worst_edge_ratio_finds_long_and_short_edges() {
        let mut cloth = square();
        assert!((cloth.worst_edge_ratio() - 1.0).abs() < 1e-12);
        cloth.positions[1].x = 3.0;
        assert!((cloth.worst_edge_ratio() - 1.5).abs() < 1e-12);
        cloth.positions[2] = cloth.positions[1] + Vec3::new(0.0, 0.1, 0.0);
        assert!((cloth.worst_edge_ratio() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn masses_add_up_to_area_times_density_and_are_positive() {
        let mut cloth = square();
        let total: f64 = cloth.masses_kg(0.3).iter().sum();
        assert!((total - 0.6).abs() < 1e-12);
        cloth.positions.push(Vec3::zeros());
        cloth.rest_positions.push(Vec3::zeros());
        assert!(cloth.masses_kg(0.3)[4] > 0.0);
    }

    #[test]
    fn append_shifts_indices_and_positions() {
        let mut cloth = square();
        cloth.append(square(), Vec3::new(0.0, 0.0, 5.0));
        assert_eq!(cloth.triangles[3], [4, 6, 7]);
        assert!((cloth.positions[4].z - 5.0).abs() < 1e-12 && cloth.rest_positions[4].z.abs() < 1e-12);
    }
}
