//! What a host has registered.

use std::sync::Arc;

use untangle::{mesh::Mesh, settings::Settings};
use untangled_proto::{CorrectionKind, PayloadLayout, Precision, SessionOptions};

/// The content of a registration, validated.
#[derive(Debug)]
pub struct Registered {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Settings of the session: the daemon's, overlaid by the host's.
    pub settings: Settings,
    /// Precision of the positions that the host will publish.
    pub precision: Precision,
    /// What corrections shall be.
    pub correction: CorrectionKind,
    /// How the samples of the session lie in shared memory.
    pub layout: PayloadLayout,
    /// What the session asks for besides.
    pub options: SessionOptions,
}
