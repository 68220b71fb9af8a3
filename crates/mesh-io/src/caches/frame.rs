//! One frame of a cache.

use std::{ops::Range, sync::Arc};

use super::singles::{self, ByteOrder};
use crate::{
    error::WriteError,
    mesh_file::MeshFile,
    usd::{self, Place},
};

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
    /// Little-endian singles in the spaces of prims.
    Prims(Vec<u8>, Arc<[Place]>),
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
            Source::Prims(_, places) => places.iter().all(|place| place.is_identity),
        }
    }

    /// Ranges of vertices whose positions can't change, each with the reason.
    #[must_use]
    pub fn fixed_vertices(&self) -> Vec<(Range<usize>, &str)> {
        match &self.source {
            Source::Singles(..) | Source::Prims(..) => Vec::new(),
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
        match &self.source {
            Source::Mesh(file) => return file.stored_positions(positions),
            Source::Prims(bytes, places) => {
                return Ok(usd::positions(&self.in_prims(bytes, places, positions)?, places));
            }
            Source::Singles(..) => {}
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
            Source::Prims(bytes, places) => {
                self.stored_positions(positions)?;
                self.in_prims(bytes, places, positions)
            }
            Source::Mesh(file) => {
                let mut bytes = Vec::new();
                file.write_with_positions(positions, &mut bytes)?;
                Ok(bytes)
            }
        }
    }

    /// The points of prims where vertices of the world are at positions; those that did not move keep their bits.
    fn in_prims(&self, bytes: &[u8], places: &[Place], positions: &[[f64; 3]]) -> Result<Vec<u8>, WriteError> {
        let largest = self.positions.as_flattened().iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let mut bytes = bytes.to_vec();
        let points = bytes.as_chunks_mut::<12>().0;
        for place in places {
            for vertex in place.vertices.clone() {
                let position = positions[vertex];
                if position.map(f64::to_bits) == self.positions[vertex].map(f64::to_bits) {
                    continue;
                }
                let stored = place.stored(position, largest).ok_or_else(|| WriteError::FixedCoordinates {
                    vertex,
                    reason: "it is beyond single precision".to_owned(),
                })?;
                for (slot, value) in points[vertex].as_chunks_mut::<4>().0.iter_mut().zip(stored) {
                    *slot = value.to_le_bytes();
                }
            }
        }
        Ok(bytes)
    }
}
