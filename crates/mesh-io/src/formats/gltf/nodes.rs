//! The nodes of a scene and their transforms.

use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3, Vector4};

use crate::error::ReadErrorKind;

use super::document::{Count, Document, Node, Single};

/// All nodes of the scene by their index, with their world transforms, parents before children.
pub(crate) fn placed_nodes(document: &Document) -> Result<Vec<(usize, Matrix4<f64>)>, ReadErrorKind> {
    let nodes = &document.nodes;
    let scene = document.scene.or((!document.scenes.is_empty()).then_some(Count(0)));
    let roots: Vec<usize> = match scene {
        Some(scene) => document.scenes[scene.0].nodes.iter().map(|node| node.0).collect(),
        None => {
            let mut is_child = vec![false; nodes.len()];
            for child in nodes.iter().flat_map(|node| &node.children) {
                is_child[child.0] = true;
            }
            (0..nodes.len()).filter(|&node| !is_child[node]).collect()
        }
    };
    let mut seen = vec![false; nodes.len()];
    let mut open: Vec<_> = roots.into_iter().rev().map(|root| (root, Matrix4::identity())).collect();
    let mut placed = Vec::new();
    while let Some((node, parent)) = open.pop() {
        // The format requires a tree; a cycle would never end.
        if std::mem::replace(&mut seen[node], true) {
            return Err(ReadErrorKind::Malformed(format!("node {node} has more than one parent")));
        }
        let world = parent * matrix_of(&nodes[node]);
        open.extend(nodes[node].children.iter().rev().map(|child| (child.0, world)));
        placed.push((node, world));
    }
    Ok(placed)
}

fn matrix_of(node: &Node) -> Matrix4<f64> {
    let number = |single: Single| f64::from(single.0);
    if let Some(matrix) = node.matrix {
        return Matrix4::from_column_slice(&matrix.map(number));
    }
    let translation = node.translation.unwrap_or_default().map(number);
    let [x, y, z, w] = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.map(number));
    let scale = node.scale.map_or([1.0; 3], |scale| scale.map(number));
    Translation3::from(translation).to_homogeneous()
        * UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous()
        * Matrix4::new_nonuniform_scaling(&Vector3::from(scale))
}

/// A stored position in the world.
pub(crate) fn to_world(transform: &Matrix4<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let world = transform * Vector4::new(x, y, z, 1.0);
    [world.x, world.y, world.z]
}
