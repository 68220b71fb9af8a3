//! Faces near a place: parry's tree of boxes.

use nalgebra::{Point3, Vector3};
use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy},
};

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// A box with sides along the axes, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Extent {
    /// The box round some points.
    pub(super) fn of(points: impl IntoIterator<Item = Point3<f64>>) -> Self {
        let empty = Self { low: Vector3::repeat(f64::INFINITY), high: Vector3::repeat(f64::NEG_INFINITY) };
        points
            .into_iter()
            .fold(empty, |Self { low, high }, at| Self { low: low.inf(&at.coords), high: high.sup(&at.coords) })
    }

    /// The box round a face.
    pub(super) fn of_face(mesh: &Mesh, frame: &Frame, face: FaceId) -> Self {
        Self::of(mesh.face(face).map(|corner| frame.position(corner)))
    }

    /// A box that is wider by a length on every side.
    pub(super) fn widened(self, by_m: f64) -> Self {
        let by = Vector3::repeat(by_m);
        Self { low: self.low - by, high: self.high + by }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    fn aabb(&self) -> Aabb {
        let vector = |at: Vector3<f64>| Vector::new(at.x, at.y, at.z);
        Aabb::new(vector(self.low), vector(self.high))
    }
}

/// All faces of a state by their boxes.
pub(super) struct FaceTree {
    tree: Bvh,
}

impl FaceTree {
    /// Cost: O(n log n) for n faces.
    pub(super) fn of(mesh: &Mesh, frame: &Frame) -> Self {
        let boxes: Vec<Aabb> = mesh.face_ids().map(|face| Extent::of_face(mesh, frame, face).aabb()).collect();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// The faces whose boxes overlap another, ascending.
    pub(super) fn overlapping(&self, extent: &Extent) -> Vec<FaceId> {
        let mut faces: Vec<FaceId> = self.tree.intersect_aabb(&extent.aabb()).map(FaceId).collect();
        faces.sort_unstable();
        faces
    }
}
