//! What a displacement costs: as-rigid-as-possible energies (ARAP; Sorkine and Alexa 2007) and their linear systems.
//!
//! | file | purpose |
//! |---|---|
//! | `domain` | the free vertices, with the symbolic factorisation that all systems over them share |
//! | `rotation` | the rotation nearest to a matrix (polar decomposition) |
//! | `vertex_arap` | ARAP energy with one rotation per vertex: the least change of shape |
//! | `stiffness` | its quadratic part as a factorised matrix |
//! | `triangle_arap` | ARAP energy of one triangle, with its rest shape in the plane |
//! | `flattening` | the energy of the flattening flow: ARAP of all triangles, and bending |

mod domain;
mod flattening;
mod rotation;
mod stiffness;
mod triangle_arap;
mod vertex_arap;

pub(crate) use domain::Domain;
pub(crate) use flattening::{FlatteningEnergy, FlatteningSystem};
pub(crate) use rotation::nearest_rotation;
pub(crate) use stiffness::StiffnessMatrix;
pub(crate) use vertex_arap::{ArapEnergy, RestShape};
