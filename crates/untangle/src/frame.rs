//! Validated positions of one instant.

use nalgebra::Point3;
use thiserror::Error;

use crate::{
    mesh::{Mesh, VertexId},
    predicates::Site,
};

/// Why positions were refused.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum FrameError {
    /// Not one position for each vertex.
    #[error("{given} positions were given for {expected} vertices")]
    Length {
        /// Positions given.
        given: usize,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or too large for exact arithmetic.
    #[error("vertex {vertex} has coordinate {axis} = {value:e}; coordinates must be finite and at most 2^250")]
    Coordinate {
        /// The vertex at fault.
        vertex: usize,
        /// `x`, `y` or `z`.
        axis: char,
        /// The value at fault.
        value: f64,
    },
}

/// Positions of all vertices at one instant, `num_vertices x 3`, metres, finite.
///
/// Coordinates in single precision are converted exactly. Magnitudes below 2^-250 are taken as zero and those over
/// 2^250 refused: in between, the determinants of [`predicates`](crate::predicates) neither under- nor overflow, and
/// their signs are exact.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    positions: Vec<Point3<f64>>,
}

const LARGEST: f64 = f64::from_bits((1023 + 250) << 52);
const SMALLEST: f64 = f64::from_bits((1023 - 250) << 52);

impl Frame {
    /// Validates positions in double precision.
    ///
    /// # Errors
    /// [`FrameError`], naming the vertex at fault.
    pub fn new(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<Self, FrameError> {
        let mut frame = Self::default();
        frame.set(mesh, positions.iter().copied())?;
        Ok(frame)
    }

    /// Takes the positions of another instant, reusing the memory. On an error the frame holds nothing usable.
    ///
    /// # Errors
    /// [`FrameError`], naming the vertex at fault.
    pub fn set<T: Into<f64> + Copy>(
        &mut self,
        mesh: &Mesh,
        positions: impl ExactSizeIterator<Item = [T; 3]>,
    ) -> Result<(), FrameError> {
        self.positions.clear();
        if positions.len() != mesh.num_vertices() {
            return Err(FrameError::Length { given: positions.len(), expected: mesh.num_vertices() });
        }
        // A zero of either sign becomes a positive one.
        self.positions.extend(positions.map(|position| Point3::from(position.map(|value| value.into() + 0.0))));
        // All at once, without a branch: hardly any frame has a coordinate that needs a second look.
        let is_plain = |value: f64| (SMALLEST..=LARGEST).contains(&value.abs()) | (value == 0.0);
        let is_all_plain =
            |all, point: &Point3<f64>| all & point.iter().fold(true, |all, &value| all & is_plain(value));
        if self.positions.iter().fold(true, is_all_plain) { Ok(()) } else { self.look_at_each() }
    }

    /// Takes the smallest values as zero, and refuses the first that can't be used.
    fn look_at_each(&mut self) -> Result<(), FrameError> {
        let mut fault = None;
        for (vertex, point) in self.positions.iter_mut().enumerate() {
            for (value, axis) in point.iter_mut().zip(['x', 'y', 'z']) {
                let magnitude = value.abs();
                if magnitude.is_nan() || magnitude > LARGEST {
                    fault.get_or_insert(FrameError::Coordinate { vertex, axis, value: *value });
                } else if magnitude < SMALLEST {
                    *value = 0.0;
                }
            }
        }
        fault.map_or(Ok(()), |fault| {
            self.positions.clear();
            Err(fault)
        })
    }

    /// Moves one vertex; nothing where the place is refused, and the vertex stays.
    pub(crate) fn put(&mut self, vertex: VertexId, place: Point3<f64>) -> Option<()> {
        let is_usable = place.iter().all(|value| value.abs() <= LARGEST);
        is_usable.then(|| {
            self.positions[vertex.index()] = place.map(|value| if value.abs() < SMALLEST { 0.0 } else { value });
        })
    }

    /// All positions, in metres.
    #[must_use]
    pub fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    /// One position, in metres.
    #[must_use]
    pub fn position(&self, vertex: VertexId) -> Point3<f64> {
        self.positions[vertex.index()]
    }

    /// One vertex as the predicates see it.
    #[must_use]
    pub(crate) fn site(&self, vertex: VertexId) -> Site {
        Site { position: self.positions[vertex.index()].coords.into(), index: vertex.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    fn mesh() -> Mesh {
        Mesh::new(MeshDescription { num_vertices: 3, faces: vec![[0, 1, 2]], ..Default::default() }).unwrap()
    }

    #[test]
    fn frame_refuses_bad_positions_and_names_the_vertex() {
        let error = |positions: &[[f64; 3]]| Frame::new(&mesh(), positions).unwrap_err();
        assert_eq!(error(&[[0.0; 3]; 2]), FrameError::Length { given: 2, expected: 3 });
        for value in [f64::INFINITY, 1e300] {
            let expected = FrameError::Coordinate { vertex: 1, axis: 'y', value };
            assert_eq!(error(&[[0.0; 3], [0.0, value, 0.0], [0.0; 3]]), expected);
        }
        assert!(matches!(
            error(&[[0.0; 3], [0.0; 3], [0.0, 0.0, f64::NAN]]),
            FrameError::Coordinate { vertex: 2, axis: 'z', .. }
        ));
    }

    #[test]
    fn frame_converts_f32_exactly_and_takes_tiny_values_as_zero() {
        let mut frame = Frame::default();
        frame.set(&mesh(), [[0.1f32, f32::MAX, f32::MIN_POSITIVE]; 3].into_iter()).unwrap();
        assert_eq!(frame.position(VertexId(2)), Point3::from([0.1f32, f32::MAX, f32::MIN_POSITIVE].map(f64::from)));
        let frame = Frame::new(&mesh(), &[[1e-80, -1e-300, 1.0]; 3]).unwrap();
        assert_eq!(frame.position(VertexId(0)), Point3::new(0.0, 0.0, 1.0));
    }
}
