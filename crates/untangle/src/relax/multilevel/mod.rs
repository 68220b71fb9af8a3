//! Coarser meshes of one surface. A deep tangle is fewer edges deep there, and motions of it cost less; where it comes
//! apart, the finer mesh begins from that state.
//!
//! | file | purpose |
//! |---|---|
//! | `removed` | where a vertex that a coarser mesh has no more lies on what is left |
//! | `collapse` | vertices are removed one by one |
//! | `coarser` | the coarser mesh, and a state of it carried over to the finer one |
//!
//! A row uses those above it only.

mod coarser;
mod collapse;
mod removed;
#[cfg(test)]
mod tests;

pub(super) use coarser::CoarserMesh;
