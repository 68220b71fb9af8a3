//! The bytes of a layer: a file, or a part of one, read where they are needed.

use std::{
    fs::{self, File},
    io,
    os::unix::fs::FileExt,
    path::Path,
};

use crate::usd::fault::Fault;

/// Bytes of mesh that a layer may ask for, for each byte of its own.
const MOST_EXPANSION: u64 = 64;
/// What a layer of any length may ask for.
const ALWAYS: u64 = 1 << 20;

/// An open layer file.
#[derive(Debug)]
pub(super) struct Source {
    file: File,
    start: u64,
    length: u64,
}

impl Source {
    /// Opens a regular file.
    pub(super) fn open(path: &Path) -> Result<Self, Fault> {
        // Asked before it is opened: a pipe would wait for somebody to write.
        let metadata = fs::metadata(path)?;
        if !metadata.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file").into());
        }
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        Ok(Self { file, start: 0, length: metadata.len() })
    }

    /// A part of it; the part must lie within.
    pub(super) fn part(self, start: u64, length: u64) -> Result<Self, Fault> {
        self.check(start, length)?;
        Ok(Self { file: self.file, start: self.start + start, length })
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Most bytes of decoded values that a file of this length may give.
    pub(super) fn budget(&self) -> u64 {
        self.length.saturating_mul(MOST_EXPANSION).saturating_add(ALWAYS)
    }

    fn check(&self, start: u64, length: u64) -> Result<(), Fault> {
        match start.checked_add(length) {
            Some(end) if end <= self.length => Ok(()),
            _ => Err(Fault::new("refers to bytes beyond its end")),
        }
    }

    /// Bytes at an offset; refused before anything is allocated where the file has not as many.
    pub(super) fn read(&self, start: u64, length: u64) -> Result<Vec<u8>, Fault> {
        self.check(start, length)?;
        let size = usize::try_from(length).map_err(|_| Fault::new("has more bytes than this machine can hold"))?;
        let mut bytes = vec![0; size];
        self.file.read_exact_at(&mut bytes, self.start + start)?;
        Ok(bytes)
    }

    pub(super) fn array<const N: usize>(&self, start: u64) -> Result<[u8; N], Fault> {
        self.check(start, N as u64)?;
        let mut bytes = [0; N];
        self.file.read_exact_at(&mut bytes, self.start + start)?;
        Ok(bytes)
    }

    pub(super) fn number(&self, start: u64) -> Result<u64, Fault> {
        self.array(start).map(u64::from_le_bytes)
    }
}
