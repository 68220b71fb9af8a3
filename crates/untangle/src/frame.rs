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
        self.positions.reserve(positions.len());
        for (vertex, position) in positions.enumerate() {
            let mut point = [0.0; 3];
            for ((slot, value), axis) in point.iter_mut().zip(position).zip(['x', 'y', 'z']) {
                let value: f64 = value.into();
                let magnitude = value.abs();
                if magnitude.is_nan() || magnitude > LARGEST {
                    return Err(FrameError::Coordinate { vertex, axis, value });
                }
                *slot = if magnitude < SMALLEST { 0.0 } else { value };
            }
            self.positions.push(point.into());
        }
        Ok(())
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
