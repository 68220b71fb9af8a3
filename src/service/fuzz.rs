//! What a peer's bytes go through before anything is done with them, and corrections before they are sent, for fuzzers and for tests of
//! limits. Not for use: it may change at any time.

use std::sync::Arc;

use untangled_proto::{CorrectionKind, PositionF32, PositionF64, StateHeader, VertexCorrection, sections::Sections};

use untangle::{frame::Frame, mesh::Mesh, respond::Corrections, settings::Settings};

use super::{ServeOptions, ingest, publish, register};

/// A registration as the daemon reads it; refused in words.
///
/// # Errors
/// The words.
pub fn registration(
    payload: &[u8],
    num_sections: u32,
    options: &ServeOptions,
) -> Result<(Arc<Mesh>, Settings), String> {
    let num_sections = usize::try_from(num_sections).unwrap_or(usize::MAX);
    let sections = Sections::parse(payload, num_sections).map_err(|error| error.to_string())?;
    let registered = register::read(&sections, options, 0).map_err(|refusal| refusal.message)?;
    Ok((registered.mesh, registered.settings))
}

/// A settings request as the daemon reads it; refused in words.
///
/// # Errors
/// The words.
pub fn settings(payload: &[u8], num_sections: u32, options: &ServeOptions) -> Result<Settings, String> {
    let num_sections = usize::try_from(num_sections).unwrap_or(usize::MAX);
    let sections = Sections::parse(payload, num_sections).map_err(|error| error.to_string())?;
    register::settings(&sections, options).map_err(|refusal| refusal.message)
}

/// Positions as a sample holds them.
#[derive(Clone, Copy, Debug)]
pub enum Positions<'a> {
    /// Single precision.
    F32(&'a [PositionF32]),
    /// Double precision.
    F64(&'a [PositionF64]),
}

/// A state as the daemon reads it; whether it can be used.
pub fn state(header: &StateHeader, positions: Positions<'_>, mesh: &Mesh, frame: &mut Frame) -> bool {
    let read = match positions {
        Positions::F32(positions) => ingest::read_f32(frame, mesh, positions),
        Positions::F64(positions) => ingest::read_f64(frame, mesh, positions),
    };
    read.and_then(|()| ingest::check_header(header, mesh.num_vertices())).is_ok()
}

/// The correction of one vertex as the daemon sends it, for a frame whose step is `dt_s`.
#[must_use]
pub fn correction(
    mesh: &Mesh,
    corrections: &Corrections,
    kind: CorrectionKind,
    dt_s: f64,
    vertex: usize,
) -> VertexCorrection {
    publish::vertex(mesh, corrections, kind, dt_s, vertex)
}
