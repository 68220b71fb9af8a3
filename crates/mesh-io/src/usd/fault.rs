//! Why USD was not read.

use std::{io, path::PathBuf};

use thiserror::Error;

use crate::printable::{Printable, Reason};

/// A USD file that can't be read, or a prim in it that can't be used.
#[derive(Debug, Error)]
#[error(
    "{}{}: {}{}",
    Printable(path.display()),
    line.map_or(String::new(), |line| format!(":{line}")),
    prim.as_ref().map_or(String::new(), |prim| format!("prim {}: ", Reason(prim))),
    Reason(reason)
)]
pub struct UsdError {
    /// The layer at fault, or the root layer.
    pub path: PathBuf,
    /// Line at fault, counted from 1, in a text layer.
    pub line: Option<usize>,
    /// The prim at fault.
    pub prim: Option<String>,
    /// What is wrong, in words.
    pub reason: String,
}

/// What is wrong within one layer.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) line: Option<usize>,
    pub(super) reason: String,
}

impl Fault {
    pub(super) fn new(reason: impl Into<String>) -> Self {
        Self { line: None, reason: reason.into() }
    }

    /// The error of a layer.
    pub(super) fn at(self, path: PathBuf) -> UsdError {
        UsdError { path, line: self.line, prim: None, reason: self.reason }
    }
}

impl From<io::Error> for Fault {
    fn from(source: io::Error) -> Self {
        Self::new(format!("can't be read: {source}"))
    }
}
