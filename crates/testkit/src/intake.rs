//! The daemon's reading of what a peer sends, as functions of bytes: for fuzzers and for tests of limits.

use std::sync::Arc;

use untangle::{frame::Frame, mesh::Mesh, settings::Settings};
use untangled::service::{ServeOptions, requests, session::ingest};
use untangled_proto::{PayloadLayout, PositionF32, PositionF64, StateHeader, sections::Sections};

/// A registration as the daemon reads it.
///
/// # Errors
/// The message of the refusal.
pub fn read_registration(
    payload: &[u8],
    num_sections: u32,
    options: &ServeOptions,
) -> Result<(Arc<Mesh>, Settings), String> {
    let sections = parse(payload, num_sections)?;
    let registered = requests::registration::read(&sections, options, PayloadLayout::Packed, 0)
        .map_err(|refusal| refusal.message)?;
    Ok((Arc::clone(registered.cloth.mesh()), registered.settings))
}

/// A settings request as the daemon reads it.
///
/// # Errors
/// The message of the refusal.
pub fn read_settings(payload: &[u8], num_sections: u32, options: &ServeOptions) -> Result<Settings, String> {
    requests::registration::settings(&parse(payload, num_sections)?, options).map_err(|refusal| refusal.message)
}

fn parse(payload: &[u8], num_sections: u32) -> Result<Sections<'_>, String> {
    Sections::parse(payload, usize::try_from(num_sections).unwrap_or(usize::MAX)).map_err(|error| error.to_string())
}

/// Positions as a sample holds them.
#[derive(Clone, Copy, Debug)]
pub enum Positions<'a> {
    /// Single precision.
    F32(&'a [PositionF32]),
    /// Double precision.
    F64(&'a [PositionF64]),
}

/// Reads a state as the daemon does; whether it is accepted.
pub fn accept_state(header: &StateHeader, positions: Positions<'_>, mesh: &Mesh, frame: &mut Frame) -> bool {
    let read = match positions {
        Positions::F32(positions) => ingest::read_f32(frame, mesh, positions),
        Positions::F64(positions) => ingest::read_f64(frame, mesh, positions),
    };
    read.and_then(|()| ingest::check_header(header, mesh.num_vertices())).is_ok()
}
