//! Seams: vertices in one place that are one vertex for topology, intersections, charts and moving.
//!
//! Exporters split vertices where texture coordinates or normals differ. The parts of a split vertex lie in exactly one
//! place, and to the symbolic perturbation they are points apart, so that a clean cloth seems to cross itself along its
//! seams. A [`Weld`] says which vertices of an input are one *welded vertex*, makes the description of the welded mesh,
//! and takes positions there and back. Ids outside stay as they were; faces keep their ids.
//!
//! To be in one place is not enough: sheets that cross or touch have vertices in one place too, and to weld these
//! would hide what is wrong with them. Two vertices in one place are welded where
//!
//! - two edges lie in one place, of which at least one is a boundary edge (a seam; a pocket sewn onto a cloth). Where
//!   a boundary edge lies on several edges that are none, it is unclear which one it belongs to, and it stays apart
//!   from them. Two layers, whose faces at the edge coincide and face the same way, stay apart;
//! - an edge without length joins them, and to contract it leaves the cloth what it was (link condition);
//! - one of them is used by no face: it goes with the first vertex in its place that is.
//!
//! The two sides of a double-sided cloth so stay what their faces say: they are joined along their hems only, where
//! both end. Sheets that touch in single points, or cross through common places, stay apart. Nothing is welded across
//! parts (files), nor a body with a cloth: they are pieces of their own.
//!
//! | file | purpose |
//! |---|---|
//! | `places` | which vertices lie in one place, exactly or within a distance |
//! | `seams` | which of these are one vertex |
//! | `groups` | disjoint sets |

mod groups;
mod places;
mod seams;
#[cfg(test)]
mod tests;

use std::ops::Range;

use thiserror::Error;

use crate::mesh::{Csr, MeshDescription, MeshError, VertexId};

/// Why no weld can be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WeldError {
    /// The mesh itself is refused.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Not one position for each vertex.
    #[error("{given} positions were given for {expected} vertices")]
    Length {
        /// Positions given.
        given: usize,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// The distance is no distance.
    #[error("vertices can't be welded within {0} m; the distance must be finite and not negative")]
    Distance(f64),
}

/// Which vertices of an input are one welded vertex.
#[derive(Clone, Debug)]
pub struct Weld {
    /// The welded vertex of each vertex.
    welded: Vec<u32>,
    /// The vertices of each welded vertex, ascending; welded vertices are in the order of their first.
    copies: Csr<u32>,
    num_welded: usize,
    /// Whether vertices within a distance are welded, not only those in exactly one place.
    within: bool,
}

impl Weld {
    /// No weld: each vertex is a welded vertex of its own.
    #[must_use]
    pub fn none(num_vertices: usize) -> Self {
        Self::from_first((0..u32::try_from(num_vertices).unwrap_or(u32::MAX)).collect(), false)
    }

    /// Finds the seams of a mesh by its positions in metres, `num_vertices x 3`.
    ///
    /// Vertices are in one place if their coordinates are equal (a zero of either sign is zero), or for a positive
    /// `distance_m` if a chain of vertices joins them whose links are at most that long. The order of vertices and
    /// faces plays no part. Vertices of different `parts` (ranges that do not overlap; none for one part) are never
    /// welded, nor is a vertex of a body with one of a cloth.
    ///
    /// Cost: O(n log n), and for a distance some 60 look-ups a vertex.
    ///
    /// # Errors
    /// [`WeldError`].
    pub fn find(
        description: &MeshDescription,
        positions: &[[f64; 3]],
        parts: &[Range<usize>],
        distance_m: f64,
    ) -> Result<Self, WeldError> {
        description.validate()?;
        let expected = description.num_vertices;
        if positions.len() != expected {
            return Err(WeldError::Length { given: positions.len(), expected });
        }
        if !(distance_m.is_finite() && distance_m >= 0.0) {
            return Err(WeldError::Distance(distance_m));
        }
        let parts = places::parts_of(expected, parts, &description.body);
        let exact = places::exact(positions, &parts);
        let within = distance_m > 0.0;
        let near = if within { places::within(positions, &parts, distance_m) } else { exact.clone() };
        Ok(Self::from_first(seams::find(&description.faces, &near, &exact), within))
    }

    /// From the first vertex of each vertex's group.
    fn from_first(first: Vec<u32>, within: bool) -> Self {
        let mut welded = vec![0; first.len()];
        let mut num_welded = 0;
        for (vertex, &first) in first.iter().enumerate() {
            if first as usize == vertex {
                welded[vertex] = num_welded;
                num_welded += 1;
            } else {
                welded[vertex] = welded[first as usize];
            }
        }
        let pairs = welded.iter().zip(0..).map(|(&welded, vertex)| (welded as usize, vertex));
        let copies = Csr::from_pairs(num_welded as usize, pairs);
        Self { welded, copies, num_welded: num_welded as usize, within }
    }

    /// Number of vertices of the input.
    #[must_use]
    pub fn num_vertices(&self) -> usize {
        self.welded.len()
    }

    /// Whether only vertices in exactly one place are welded.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        !self.within
    }

    /// Number of vertices that became one with an earlier one: so many fewer has the welded mesh.
    #[must_use]
    pub fn num_merged(&self) -> usize {
        self.welded.len() - self.num_welded
    }

    /// The welded vertex of a vertex of the input.
    #[must_use]
    pub fn of(&self, vertex: u32) -> VertexId {
        VertexId(self.welded[vertex as usize])
    }

    /// The welded vertex of each vertex of the input.
    #[must_use]
    pub fn welded_vertices(&self) -> &[u32] {
        &self.welded
    }

    /// The vertices of the input that are this welded vertex, ascending.
    #[must_use]
    pub fn copies(&self, welded: VertexId) -> &[u32] {
        self.copies.row(welded.index())
    }

    /// The lowest of the vertices of the input that are this welded vertex.
    #[must_use]
    pub fn first(&self, welded: VertexId) -> u32 {
        self.copies(welded)[0]
    }

    /// The description of the welded mesh. Faces and texture coordinates, which belong to corners, keep their order;
    /// masses are summed; a welded vertex is pinned, or of a body, if one of its copies is; rest position and layer are
    /// those of its first copy.
    #[must_use]
    pub fn describe(&self, description: &MeshDescription) -> MeshDescription {
        let MeshDescription { faces, uvs, rest_positions, masses_kg, pins, layers, body, .. } = description;
        let of_first = |welded: usize| self.copies.row(welded)[0] as usize;
        let welded = |vertices: &[u32]| {
            let mut welded: Vec<u32> = vertices.iter().map(|&vertex| self.welded[vertex as usize]).collect();
            welded.sort_unstable();
            welded.dedup();
            welded
        };
        MeshDescription {
            num_vertices: self.num_welded,
            faces: faces.iter().map(|corners| corners.map(|corner| self.welded[corner as usize])).collect(),
            uvs: uvs.clone(),
            rest_positions: rest_positions
                .as_ref()
                .map(|rest| (0..self.num_welded).map(|welded| rest[of_first(welded)]).collect()),
            masses_kg: masses_kg.as_ref().map(|masses| {
                let sum = |welded| self.copies.row(welded).iter().map(|&copy| masses[copy as usize]).sum();
                (0..self.num_welded).map(sum).collect()
            }),
            pins: welded(pins),
            body: welded(body),
            layers: layers.as_ref().map(|layers| (0..self.num_welded).map(|welded| layers[of_first(welded)]).collect()),
        }
    }

    /// Positions of the welded vertices in metres, `num_welded x 3`, from those of the input: the middle of the box
    /// round all copies, which for copies in exactly one place is that place.
    #[must_use]
    pub fn gather(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let place = |welded: usize| {
            let copies = self.copies.row(welded);
            let first = positions[copies[0] as usize];
            if !self.within || copies.len() == 1 {
                return first;
            }
            let (mut low, mut high) = (first, first);
            for &copy in copies {
                for (axis, value) in positions[copy as usize].into_iter().enumerate() {
                    (low[axis], high[axis]) = (low[axis].min(value), high[axis].max(value));
                }
            }
            std::array::from_fn(|axis| low[axis] + 0.5 * (high[axis] - low[axis]))
        };
        (0..self.num_welded).map(place).collect()
    }

    /// Takes welded positions back to the vertices of the input: `before` are the positions of the input,
    /// `num_vertices x 3`, `after` those of the welded vertices, `num_welded x 3`.
    ///
    /// Copies of a welded vertex that did not move keep their bits. Copies in exactly one place stay in one place, to
    /// the bit; copies within a distance are all displaced by the same vector.
    #[must_use]
    pub fn scatter(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let start = self.gather(before);
        let back = |(own, &welded): (&[f64; 3], &u32)| {
            let [start, end] = [start[welded as usize], after[welded as usize]];
            std::array::from_fn(|axis| displaced(own[axis], start[axis], end[axis]))
        };
        before.iter().zip(&self.welded).map(back).collect()
    }
}

/// A coordinate of a copy whose welded vertex went from `start` to `end`.
#[expect(clippy::float_cmp, reason = "equal coordinates keep their bits or take those of the welded vertex")]
fn displaced(own: f64, start: f64, end: f64) -> f64 {
    if start == end {
        own
    } else if own == start {
        end
    } else {
        own + (end - start)
    }
}
