//! Validated positions of one instant.

use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::Point3;
use thiserror::Error;

use crate::{
    mesh::{Mesh, MeshIdentity, VERTICES_PER_BLOCK, VertexId},
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
    /// The mesh that the positions are of, if it has bodies.
    mesh: Option<MeshIdentity>,
    body: BodyVersion,
}

/// Where the bodies of a frame are: two frames of a mesh with the same version have all vertices of bodies in the same
/// places. So whoever keeps something of bodies from frame to frame need not look at them to know that it still holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BodyVersion(u64);

impl BodyVersion {
    /// Without bodies, or where nobody compared them.
    const UNKNOWN: Self = Self(0);

    /// One that no frame has had.
    fn fresh() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(LAST.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// Whether there are bodies, all of which are where they were at an earlier version.
    pub(crate) fn is_still(self, earlier: Self) -> bool {
        self != Self::UNKNOWN && self == earlier
    }
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
    /// Positions of bodies that are what they were are compared, and not written or checked again.
    ///
    /// # Errors
    /// [`FrameError`], naming the vertex at fault.
    pub fn set<T: Into<f64> + Copy>(
        &mut self,
        mesh: &Mesh,
        positions: impl ExactSizeIterator<Item = [T; 3]>,
    ) -> Result<(), FrameError> {
        if positions.len() != mesh.num_vertices() {
            self.positions.clear();
            return Err(FrameError::Length { given: positions.len(), expected: mesh.num_vertices() });
        }
        // A zero of either sign becomes a positive one.
        let places = positions.map(|position| Point3::from(position.map(|value| value.into() + 0.0)));
        let is_plain = if mesh.has_body() && self.is_of(mesh) {
            self.replace(mesh, places)
        } else {
            self.positions.clear();
            self.positions.extend(places);
            self.mesh = mesh.has_body().then(|| mesh.identity().clone());
            self.body = if mesh.has_body() { BodyVersion::fresh() } else { BodyVersion::UNKNOWN };
            are_plain(&self.positions)
        };
        if is_plain { Ok(()) } else { self.look_at_each() }
    }

    /// Whether it holds positions of a mesh with bodies.
    fn is_of(&self, mesh: &Mesh) -> bool {
        self.mesh.as_ref() == Some(mesh.identity()) && self.positions.len() == mesh.num_vertices()
    }

    /// Takes the places of another instant of the same mesh; whether all that differ or are no bodies' are plain.
    fn replace(&mut self, mesh: &Mesh, mut places: impl Iterator<Item = Point3<f64>>) -> bool {
        let (mut has_body_moved, mut is_plain) = (false, true);
        for (block, vertices) in self.positions.chunks_mut(VERTICES_PER_BLOCK).enumerate() {
            let mut is_written = !mesh.is_body_block(block);
            if is_written {
                let first = block * VERTICES_PER_BLOCK;
                for (offset, (place, now)) in vertices.iter_mut().zip(&mut places).enumerate() {
                    has_body_moved |= *place != now && mesh.is_body(VertexId::from_index(first + offset));
                    *place = now;
                }
            } else {
                for (place, now) in vertices.iter_mut().zip(&mut places).filter(|(place, now)| **place != *now) {
                    (*place, is_written) = (now, true);
                }
                has_body_moved |= is_written;
            }
            is_plain &= !is_written || are_plain(vertices);
        }
        if has_body_moved {
            self.body = BodyVersion::fresh();
        }
        is_plain
    }

    /// Where its bodies are.
    pub(crate) fn body_version(&self) -> BodyVersion {
        self.body
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
            self.body = BodyVersion::UNKNOWN;
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

/// Whether no coordinate needs a second look: all at once, without a branch, since hardly any frame has one.
fn are_plain(positions: &[Point3<f64>]) -> bool {
    let is_plain = |value: f64| (SMALLEST..=LARGEST).contains(&value.abs()) | (value == 0.0);
    positions.iter().fold(true, |all, point| all & point.iter().fold(true, |all, &value| all & is_plain(value)))
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

    /// A body of more than a block, then a triangle of cloth.
    fn body_and_cloth() -> (Mesh, Vec<[f64; 3]>) {
        let num_body = u32::try_from(3 * (VERTICES_PER_BLOCK / 2)).unwrap();
        let faces = vec![[0, 1, 2], [num_body, num_body + 1, num_body + 2]];
        let (num_vertices, body) = (num_body as usize + 3, (0..num_body).collect());
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, body, ..Default::default() }).unwrap();
        let positions = (0..num_body + 3).map(|vertex| [f64::from(vertex), 1.0, 0.0]).collect();
        (mesh, positions)
    }

    #[test]
    fn frame_has_a_new_body_version_only_where_a_vertex_of_a_body_is_elsewhere() {
        let (mesh, mut positions) = body_and_cloth();
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        let mut set = |positions: &[[f64; 3]]| {
            frame.set(&mesh, positions.iter().copied()).unwrap();
            assert!(frame.positions().iter().zip(positions).all(|(place, &given)| *place == Point3::from(given)));
            frame.body_version()
        };
        let first = set(&positions);
        let num_body = positions.len() - 3;
        positions[num_body + 1] = [0.5; 3];
        assert!(set(&positions).is_still(first));
        // In a block of a body alone, and in one with cloth beside it.
        for vertex in [7, VERTICES_PER_BLOCK + 7] {
            let before = set(&positions);
            positions[vertex][1] = 2.0;
            let after = set(&positions);
            assert!(!after.is_still(before) && set(&positions).is_still(after));
        }
        let other = mesh.with_pins([]);
        assert!(frame.set(&other, positions.iter().copied()).is_ok(), "a clone is the same mesh");
        let (other, positions) = body_and_cloth();
        let before = frame.body_version();
        frame.set(&other, positions.iter().copied()).unwrap();
        assert!(!frame.body_version().is_still(before));
    }

    #[test]
    fn frame_refuses_a_bad_position_of_a_body_that_was_good_before_and_takes_the_next_good_one() {
        let (mesh, positions) = body_and_cloth();
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        for (vertex, value) in [(3, f64::NAN), (VERTICES_PER_BLOCK + 1, f64::INFINITY)] {
            let mut bad = positions.clone();
            bad[vertex][2] = value;
            let error = frame.set(&mesh, bad.iter().copied()).unwrap_err();
            assert!(matches!(error, FrameError::Coordinate { vertex: at, axis: 'z', .. } if at == vertex));
            frame.set(&mesh, positions.iter().copied()).unwrap();
            assert_eq!(frame.position(VertexId::from_index(vertex)), Point3::from(positions[vertex]));
        }
        let mut tiny = positions.clone();
        tiny[3][2] = 1e-80;
        frame.set(&mesh, tiny.iter().copied()).unwrap();
        assert_eq!(frame.position(VertexId(3)).z.to_bits(), 0);
    }

    #[test]
    fn frame_without_bodies_or_with_a_vertex_put_elsewhere_is_never_still() {
        let frame = Frame::new(&mesh(), &[[0.0; 3]; 3]).unwrap();
        assert!(!frame.body_version().is_still(frame.body_version()));
        let (mesh, positions) = body_and_cloth();
        let mut frame = Frame::new(&mesh, &positions).unwrap();
        assert!(frame.body_version().is_still(frame.body_version()));
        frame.put(VertexId(0), Point3::origin()).unwrap();
        assert!(!frame.body_version().is_still(frame.body_version()));
    }
}
