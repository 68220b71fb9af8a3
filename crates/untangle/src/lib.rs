//! Resolves cloth intersections: global intersection analysis of one state of a cloth, and the corrections that
//! untangle it.
//!
//! The method is that of Wicke, Lanker and Gross, "Untangling Cloth With Boundaries" (2006), with exact signs.
//!
//! ```
//! use untangle::{analysis::analyse, frame::Frame, mesh::{Mesh, MeshDescription}};
//!
//! // The tip of an upright triangle pierces a flat one.
//! let positions = [
//!     [0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0],
//!     [0.5, 1.0, 2.0], [1.5, 1.0, 2.0], [1.0, 1.1, -1.0],
//! ];
//! let faces = vec![[0, 1, 2], [3, 4, 5]];
//! let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() })?;
//! let analysis = analyse(&mesh, &Frame::new(&mesh, &positions)?);
//!
//! assert_eq!(analysis.intersections.segments.len(), 1);
//! let region = analysis.regions.vertices_of(0);
//! assert_eq!(region.iter().map(|vertex| vertex.0).collect::<Vec<_>>(), [5]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Many frames of one mesh: [`analysis::Analyser`] for the analysis, [`untangler::Untangler`] for corrections too.
//!
//! Modules stand in the order in which data passes through them; each uses only those above it.

pub mod predicates;

pub mod mesh;
mod sparse_map;

pub mod weld;

pub mod settings;
pub mod stage;

pub mod frame;
mod geodesic;
mod geometry;

pub mod simd;

pub mod intersect;

pub mod proximity;

pub mod paths;

pub mod regions;

pub mod analysis;

pub mod correspond;

pub mod labels;

pub mod respond;

pub mod sides;

pub mod relax;

pub mod coherence;

pub mod untangler;
