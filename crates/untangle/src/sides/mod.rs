//! Which vertices of a cloth are on the wrong side: inside of a body, or behind a layer that lies further in; how deep,
//! and which way leads out.
//!
//! Inside is what the faces of the bodies wind around: the generalised winding number (Jacobson, Kavan and Sorkine-
//! Hornung 2013) of a point is the sum of the solid angles of all faces, in whole spheres. Inside of a closed piece it
//! is 1 and outside 0; where parts of a body overlap it is 2 or more, and where a body has holes it fades from one to
//! the other. More than one half is inside. The sum is taken over a hierarchy, in which far clusters of faces count as
//! dipoles (Barill and others 2018).
//!
//! A closed piece whose faces point inwards, by the sign of its volume, is turned round. A piece with a boundary says
//! by its faces what is inside.
//!
//! The way out is that to the closest point of the surface, by parry's tree of triangles. Where bodies overlap, faces
//! of one may lie inside of another: only points just beyond which it is outside count.
//!
//! | file | purpose |
//! |---|---|
//! | `solid_angle` | the solid angle of a triangle |
//! | `outwards` | faces turned so that they point outwards |
//! | `winding` | the hierarchy of the winding number |
//! | `surface` | closest points and rays |
//! | `body` | these together: inside or not, and the way out |
//! | `orientation` | normals that agree from face to face |
//! | `layers` | which vertices are behind a layer that lies further in |
//! | `cluster` | vertices on the wrong side that edges join |

mod body;
mod cluster;
mod layers;
mod orientation;
mod outwards;
mod solid_angle;
mod surface;
#[cfg(test)]
mod tests;
mod winding;

use nalgebra::Vector3;

use crate::mesh::{FaceId, VertexId};

pub(crate) use body::cloth_vertices;
pub use body::{Sides, Way};
pub use cluster::{WrongCluster, clusters};
pub(crate) use layers::LayerState;
pub use layers::{ImpliedLayers, Layers};
pub(crate) use orientation::Orientation;

/// A vertex of a cloth inside of a body, or behind an inner layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrongSide {
    /// The vertex.
    pub vertex: VertexId,
    /// The way out.
    pub way: Way,
}

/// More than this part of a whole sphere is inside. The excess over one half is more than what rounding leaves of the
/// winding number of a point on the surface.
pub(crate) const INSIDE: f64 = 0.5 + 1e-9;

/// A direction from one point to another; a second choice where they coincide.
fn direction(from_to: Vector3<f64>, tiny_m: f64, otherwise: Vector3<f64>) -> Vector3<f64> {
    let length_m = from_to.norm();
    if length_m > tiny_m { from_to / length_m } else { otherwise }
}

/// The face of a body with a number among the faces of all bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Numbered {
    face: FaceId,
    /// Whether its corners were turned round.
    is_turned: bool,
}
