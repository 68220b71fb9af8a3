//! What a host has registered.

use std::sync::Arc;

use untangle::settings::Settings;
use untangled_proto::{CorrectionKind, PayloadLayout, Precision, SessionOptions};

use super::cloth::Cloth;

/// The content of a registration, validated.
#[derive(Debug)]
pub struct Registered {
    /// The mesh, and the host's vertices.
    pub cloth: Arc<Cloth>,
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
