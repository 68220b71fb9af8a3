//! One frame of a cache.

use std::ops::Range;

use super::singles::{self, ByteOrder};
use crate::{error::WriteError, mesh_file::MeshFile};

/// One frame as it was read, and how it is written.
#[derive(Clone, Debug)]
pub struct CacheFrame {
    positions: Vec<[f64; 3]>,
    source: Source,
}

#[derive(Clone, Debug)]
pub(super) enum Source {
    Singles(Vec<u8>, ByteOrder),
    Mesh(Box<MeshFile>),
}

impl CacheFrame {
    pub(super) fn new(positions: Vec<[f64; 3]>, source: Source) -> Self {
        Self { positions, source }
    }

    /// Positions in metres, `num_vertices x 3`, finite.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Whether the frame can only hold positions of single precision.
    #[must_use]
    pub fn is_single_precision(&self) -> bool {
        match &self.source {
            Source::Singles(..) => true,
            Source::Mesh(file) => file.is_single_precision(),
        }
    }

    /// Ranges of vertices whose positions can't change, each with the reason.
    #[must_use]
    pub fn fixed_vertices(&self) -> Vec<(Range<usize>, &str)> {
        match &self.source {
            Source::Singles(..) => Vec::new(),
            Source::Mesh(file) => file.fixed_vertices(),
        }
    }

    /// The positions that reading the frame gives, once it was written with these.
    ///
    /// # Errors
    /// [`WriteError`] for a wrong number of positions, and for a vertex that can't be there.
    pub fn stored_positions(&self, positions: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        let (given, expected) = (positions.len(), self.positions.len());
        if given != expected {
            return Err(WriteError::Length { given, expected });
        }
        if let Source::Mesh(file) = &self.source {
            return file.stored_positions(positions);
        }
        let mut stored = positions.to_vec();
        for (vertex, position) in stored.iter_mut().enumerate() {
            for coordinate in position {
                *coordinate = singles::rounded(*coordinate).ok_or_else(|| WriteError::FixedCoordinates {
                    vertex,
                    reason: "it is beyond single precision".to_owned(),
                })?;
            }
        }
        Ok(stored)
    }

    /// The bytes of the frame with other positions; every byte stays but those of coordinates that changed. Of a
    /// numbered mesh these are those of its file.
    ///
    /// # Errors
    /// As [`stored_positions`](Self::stored_positions).
    pub fn encode(&self, positions: &[[f64; 3]]) -> Result<Vec<u8>, WriteError> {
        match &self.source {
            Source::Singles(bytes, order) => {
                let stored = self.stored_positions(positions)?;
                let mut bytes = bytes.clone();
                singles::replace(&mut bytes, *order, &self.positions, &stored);
                Ok(bytes)
            }
            Source::Mesh(file) => {
                let mut bytes = Vec::new();
                file.write_with_positions(positions, &mut bytes)?;
                Ok(bytes)
            }
        }
    }
}
