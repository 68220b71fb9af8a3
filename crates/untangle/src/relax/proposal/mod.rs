//! What one frame proposes to its host as a displacement, judged before it goes out.
//!
//! | file | purpose |
//! |---|---|
//! | `judge` | how tangled the state is to which a displacement leads |
//! | `line_search` | displacements shortened where they do harm |
//! | `trials` | one step of the coupled response: the best of several trial displacements |
//! | `coupled` | the displacement of the coupled response, in some steps |
//! | `values` | what corrections do to vertices, as it will be sent |
//! | `displaced` | the displacement to the targets, and those of the states that it leads to |
//! | `proposer` | which displacements are tried for a frame, and what goes out |
//!
//! A row uses those above it only.

mod coupled;
mod displaced;
mod judge;
mod line_search;
mod proposer;
mod trials;
mod values;

pub(crate) use proposer::{AnalysedFrame, Proposer};
