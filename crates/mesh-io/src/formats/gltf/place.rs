//! The place of a node's positions in a buffer, and the reasons why some positions can't be replaced there.

use nalgebra::{Matrix4, RowVector4, Vector4};

use super::{
    data::accessor::{self, Component},
    document::{Accessor, Document},
    nodes::to_world,
    rest::Rest,
    usage::{Bytes, Usage, Use},
};

/// Positions in a buffer that may be replaced, each of three little-endian singles.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) accessor: usize,
    pub(crate) bytes: Bytes,
    from_world: Matrix4<f64>,
    to_world: Matrix4<f64>,
    /// Whether the stored coordinates are world coordinates.
    pub(crate) is_identity: bool,
}

impl Place {
    /// The place of a node's positions, or the reason why they can't be replaced. Cost: O(1).
    pub(crate) fn new(
        document: &Document,
        usage: &Usage,
        compression: Option<&str>,
        [node, index]: [usize; 2],
        rest: &Rest,
    ) -> Result<Self, String> {
        let to_world = &rest.to_world;
        if let Some(name) = compression {
            return Err(format!("the document uses {name}"));
        }
        let (number, node) = (node, &document.nodes[node]);
        if let Some(reason) = &rest.fixed {
            return Err(reason.clone());
        }
        if node.extensions.instancing.is_some() {
            return Err(format!("node {number} is instanced"));
        }
        let mesh = node.mesh.map(|mesh| mesh.0).unwrap_or_default();
        if usage.num_nodes_of_mesh[mesh] > 1 {
            return Err(format!("mesh {mesh} is used by more than one node"));
        }
        let accessor = &document.accessors[index];
        let Some(bytes) = movable_bytes(document, accessor).map_err(|reason| format!("accessor {index} {reason}"))?
        else {
            return Err(format!("accessor {index} has no buffer"));
        };
        if usage.uses[index] != Use::Positions(mesh) {
            return Err(format!("accessor {index} is used by something else too"));
        }
        if let Some(other) = &usage.shared_bytes[index] {
            return Err(format!("accessor {index} shares bytes with {other}"));
        }
        let inverse = to_world.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()));
        match inverse {
            Some(from_world) if to_world.row(3) == RowVector4::new(0.0, 0.0, 0.0, 1.0) => {
                let is_identity = *to_world == Matrix4::identity();
                Ok(Self { accessor: index, bytes, from_world, to_world: *to_world, is_identity })
            }
            _ => Err(format!("the transform of node {number} can't be inverted")),
        }
    }

    /// A world position as it is stored; `None` if it is beyond single precision.
    pub(crate) fn stored(&self, [x, y, z]: [f64; 3]) -> Option<[f32; 3]> {
        let local = self.from_world * Vector4::new(x, y, z, 1.0);
        #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
        let stored = [local.x as f32, local.y as f32, local.z as f32];
        stored.iter().all(|value| value.is_finite()).then_some(stored)
    }

    /// The world position that reading a stored one gives.
    pub(crate) fn read_back(&self, stored: [f32; 3]) -> [f64; 3] {
        to_world(&self.to_world, stored.map(f64::from))
    }
}

/// The bytes of positions that are plain singles; `None` without a buffer.
fn movable_bytes(document: &Document, accessor: &Accessor) -> Result<Option<Bytes>, &'static str> {
    if accessor.sparse.is_some() {
        return Err("is sparse");
    }
    match accessor::element(accessor) {
        Some((Component::F32, 3)) => Ok(Bytes::of_elements(document, accessor)),
        _ => Err("is quantised"),
    }
}
