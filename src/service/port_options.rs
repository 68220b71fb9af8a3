//! What a port of a session is made for.

use untangled_proto::{PayloadLayout, Precision, SessionOptions};
use untangled_transport::Domain;

/// The session of a port, and how its samples are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PortOptions<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) instance: u64,
    pub(crate) session: u64,
    pub(crate) num_vertices: usize,
    pub(crate) precision: Precision,
    pub(crate) layout: PayloadLayout,
    pub(crate) options: SessionOptions,
}
