//! glTF 2.0, as `.gltf` with its buffers or as `.glb`.
//!
//! Read are all triangles of the default scene (else of the first scene, else of all nodes), each mesh transformed by
//! its node, node by node in the order of the tree. Primitives of a node that use the same accessor of positions share
//! their vertices. Nothing else is merged, so a mesh that its exporter split along texture seams stays split. Morph
//! targets and skins are applied as the document itself has them, animations are not; points and lines are left out.
//! Coordinates are stored in single precision; the transforms of nodes are applied in double.
//!
//! The document is read by structures of our own (`document`), which know what positions, faces, texture coordinates
//! and nodes need; the text itself is kept, so that all else is written back. Every length in its data (`data`) is
//! checked.
//!
//! Writing back replaces positions in their buffer, and changes the text only where it must. Positions can be replaced
//! only where they are one list of singles that one node uses: see `place`, and `rest` for skins and morph targets.

mod container;
mod data;
mod document;
mod json;
mod nodes;
mod place;
mod read;
mod rest;
#[cfg(test)]
mod tests;
mod usage;
mod write;

pub(crate) use container::Container;
pub(crate) use read::parse;
pub(crate) use write::{Destination, GltfDocument};
