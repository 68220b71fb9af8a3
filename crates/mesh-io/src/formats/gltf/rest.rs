//! Where the mesh of a node is at rest: in the pose that the document itself has.
//!
//! A skin takes the place of the node's own transform: each joint moves its vertices by its own transform, after the
//! inverse of that in which it was bound. In the pose in which a mesh was bound these are one transform, but for the
//! rounding of its inverses, and positions can be replaced as those of any node.

use std::collections::HashMap;

use nalgebra::Matrix4;

use crate::error::ReadErrorKind;

use super::{
    data::{Budget, accessor::Accessors},
    document::{Document, Primitive},
    nodes::to_world,
};

/// Joints whose transforms differ by less, beside the largest number in them, are in the pose of binding.
const ROUNDING: f64 = 1e-5;
/// Bytes of a matrix, and of a vertex with four joints and weights.
const MATRIX: usize = 128;
const JOINTS: usize = 64;

/// Where a mesh is at rest.
#[derive(Clone, Debug)]
pub(crate) struct Rest {
    pub(crate) to_world: Matrix4<f64>,
    /// The transform of each joint, where these are not one.
    joints: Option<Vec<Matrix4<f64>>>,
    /// The weights of morph targets that are not zero.
    weights: Vec<(usize, f64)>,
    /// Why positions can't be replaced.
    pub(crate) fixed: Option<String>,
}

impl Rest {
    /// Where the mesh of a node is. `placed` are the transforms of all nodes of the scene.
    pub(crate) fn of(
        node: usize,
        placed: &HashMap<usize, Matrix4<f64>>,
        accessors: Accessors<'_>,
        budget: &mut Budget,
    ) -> Result<Self, ReadErrorKind> {
        let document = accessors.document;
        let own = &document.nodes[node];
        let to_world = placed.get(&node).copied().unwrap_or_else(Matrix4::identity);
        let mut rest = Self { to_world, joints: None, weights: Vec::new(), fixed: None };
        if let Some(mesh) = own.mesh.map(|mesh| (mesh.0, &document.meshes[mesh.0])) {
            let weights = own.weights.as_ref().unwrap_or(&mesh.1.weights);
            rest.weights =
                weights.iter().map(|weight| f64::from(weight.0)).enumerate().filter(|w| w.1 != 0.0).collect();
            rest.fixed = (!rest.weights.is_empty()).then(|| format!("mesh {} is morphed by its weights", mesh.0));
        }
        let Some(skin) = own.skin else { return Ok(rest) };
        let joints = joints(skin.0, placed, accessors, budget)?.filter(|_| has_joints(document, node));
        match joints.map(|joints| one(&joints).ok_or(joints)) {
            Some(Ok(matrix)) => rest.to_world = matrix,
            Some(Err(joints)) => {
                rest.joints = Some(joints);
                rest.fixed = Some(format!("node {node} is posed by its skin"));
            }
            None => rest.fixed = Some(format!("node {node} is skinned")),
        }
        Ok(rest)
    }

    /// Moves positions of a primitive to where they are at rest, still in the space of [`to_world`](Self::to_world).
    /// Returns whether they are in the world already.
    pub(crate) fn apply(
        &self,
        primitive: &Primitive,
        name: &str,
        positions: &mut [[f64; 3]],
        accessors: Accessors<'_>,
        budget: &mut Budget,
    ) -> Result<bool, ReadErrorKind> {
        let other =
            |what: &str| ReadErrorKind::Malformed(format!("{name} has {what} of another number than positions"));
        for (target, weight) in &self.weights {
            let Some(target) = primitive.targets.get(*target).and_then(|target| target.get("POSITION")) else {
                continue;
            };
            if accessors.document.accessors.get(target.0).is_none_or(|target| target.count.0 != positions.len()) {
                return Err(other("a morph target"));
            }
            budget.take(positions.len(), 24)?;
            for (position, shift) in positions.iter_mut().zip(accessors.read::<3>(target.0)?) {
                *position = std::array::from_fn(|axis| position[axis] + weight * shift[axis]);
            }
        }
        let Some(joints) = &self.joints else { return Ok(false) };
        let attribute = |kind: &str, set: usize| primitive.attributes.get(format!("{kind}_{set}").as_str());
        let mut sums = vec![[0.0; 4]; positions.len()];
        for set in 0.. {
            let (Some(indices), Some(weights)) = (attribute("JOINTS", set), attribute("WEIGHTS", set)) else { break };
            let counts = [indices, weights].map(|accessor| accessors.document.accessors[accessor.0].count.0);
            if counts != [positions.len(); 2] {
                return Err(other("joints or weights"));
            }
            budget.take(positions.len(), JOINTS)?;
            let both = accessors.read::<4>(indices.0)?.into_iter().zip(accessors.read::<4>(weights.0)?);
            for ((sum, position), (indices, weights)) in sums.iter_mut().zip(&*positions).zip(both) {
                add(sum, *position, indices, weights, joints);
            }
        }
        for (position, [x, y, z, weight]) in positions.iter_mut().zip(sums) {
            // A vertex without weights hangs on no joint.
            *position = if weight > 0.0 { [x, y, z].map(|x| x / weight) } else { to_world(&self.to_world, *position) };
        }
        Ok(true)
    }
}

/// Adds the places to which joints move a position, times their weights, and the weights.
fn add(sum: &mut [f64; 4], [x, y, z]: [f64; 3], indices: [f64; 4], weights: [f64; 4], joints: &[Matrix4<f64>]) {
    for (index, weight) in indices.into_iter().zip(weights) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was a small whole number")]
        if let Some(joint) = joints.get(index as usize) {
            let place = joint * nalgebra::Vector4::new(x, y, z, 1.0) * weight;
            *sum = std::array::from_fn(|axis| sum[axis] + if axis == 3 { weight } else { place[axis] });
        }
    }
}

/// The transforms of the joints of a skin; nothing where a joint is no node of the scene, or an inverse is missing.
fn joints(
    skin: usize,
    placed: &HashMap<usize, Matrix4<f64>>,
    accessors: Accessors<'_>,
    budget: &mut Budget,
) -> Result<Option<Vec<Matrix4<f64>>>, ReadErrorKind> {
    let Some(skin) = accessors.document.skins.get(skin) else { return Ok(None) };
    budget.take(skin.joints.len(), MATRIX)?;
    let inverses = match skin.inverse_bind_matrices {
        None => Vec::new(),
        Some(accessor) => {
            let Some(count) = accessors.document.accessors.get(accessor.0).map(|accessor| accessor.count.0) else {
                return Ok(None);
            };
            if count < skin.joints.len() {
                return Ok(None);
            }
            budget.take(count, MATRIX)?;
            accessors.read_matrices(accessor.0)?
        }
    };
    let joint = |(index, joint): (usize, &super::document::Count)| {
        let inverse = inverses.get(index).map_or_else(Matrix4::identity, |inverse| Matrix4::from_column_slice(inverse));
        placed.get(&joint.0).map(|joint| joint * inverse)
    };
    Ok(skin.joints.iter().enumerate().map(joint).collect())
}

/// Whether all triangles of a node's mesh have joints and weights.
fn has_joints(document: &Document, node: usize) -> bool {
    let mesh = document.nodes[node].mesh.map(|mesh| &document.meshes[mesh.0]);
    mesh.into_iter()
        .flat_map(|mesh| &mesh.primitives)
        .all(|primitive| ["JOINTS_0", "WEIGHTS_0"].iter().all(|name| primitive.attributes.contains_key(*name)))
}

/// The one transform of all joints, if they have one.
fn one(joints: &[Matrix4<f64>]) -> Option<Matrix4<f64>> {
    let first = joints.first()?;
    let is_near = |a: &Matrix4<f64>, b: &Matrix4<f64>| (a - b).amax() <= ROUNDING * a.amax().max(1.0);
    if !joints.iter().all(|joint| is_near(first, joint)) {
        return None;
    }
    let mut matrix = *first;
    if is_near(&Matrix4::identity(), first) {
        matrix = Matrix4::identity();
    }
    matrix.set_row(3, &nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0));
    Some(matrix)
}
