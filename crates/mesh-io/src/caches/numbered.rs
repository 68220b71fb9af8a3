//! Numbered meshes: a file for each frame, all with the connectivity of the mesh.

use std::{fs, ops::RangeInclusive, path::Path};

use super::{
    error::{CacheError, CacheErrorKind},
    pattern::Pattern,
    topology::Topology,
};
use crate::mesh_file::{MeshFile, parse_mesh};

/// The files of a pattern.
#[derive(Debug)]
pub(super) struct Numbered {
    pub(super) pattern: Pattern,
    pub(super) frames: RangeInclusive<u64>,
}

impl Numbered {
    /// Finds the files of a pattern; their numbers must have no gap.
    pub(super) fn open(path: &Path) -> Result<Self, CacheError> {
        let error = |frame, kind| CacheError { path: path.to_path_buf(), frame, kind };
        let pattern = Pattern::new(path).map_err(|kind| error(None, kind))?;
        let numbers = pattern.find().map_err(|kind| error(None, kind))?;
        let [Some(&first), Some(&last)] = [numbers.first(), numbers.last()] else {
            return Err(error(None, CacheErrorKind::NoMatch));
        };
        if let Some((gap, _)) = (first..=last).zip(&numbers).find(|(wanted, there)| wanted != *there) {
            return Err(CacheError { path: pattern.file(gap), frame: Some(gap), kind: CacheErrorKind::Gap });
        }
        Ok(Self { pattern, frames: first..=last })
    }

    /// Reads one file.
    pub(super) fn read(&self, frame: u64, topology: &Topology) -> Result<MeshFile, CacheError> {
        let path = self.pattern.file(frame);
        let bytes = fs::read(&path).map_err(|io| CacheError {
            path: path.clone(),
            frame: Some(frame),
            kind: CacheErrorKind::Io(io),
        })?;
        self.parse(frame, bytes, topology)
    }

    /// What reading a file of these bytes gives.
    pub(super) fn parse(&self, frame: u64, bytes: Vec<u8>, topology: &Topology) -> Result<MeshFile, CacheError> {
        let path = self.pattern.file(frame);
        let parsed = parse_mesh(bytes, &path).map_err(CacheErrorKind::from);
        let checked = parsed.and_then(|file| {
            topology.check(&file)?;
            check_size(file.positions())?;
            Ok(file)
        });
        checked.map_err(|kind| CacheError { path, frame: Some(frame), kind })
    }
}

/// Largest coordinate that exact arithmetic takes.
const LARGEST: f64 = f64::from_bits((1023 + 250) << 52);

fn check_size(positions: &[[f64; 3]]) -> Result<(), CacheErrorKind> {
    for (vertex, position) in positions.iter().enumerate() {
        for (&value, axis) in position.iter().zip(['x', 'y', 'z']) {
            if value.abs() > LARGEST {
                return Err(CacheErrorKind::NotFinite { vertex, axis, value });
            }
        }
    }
    Ok(())
}
