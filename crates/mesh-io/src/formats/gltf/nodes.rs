//! The nodes of a scene and their transforms.

use gltf::{Document, Node, scene::Transform};
use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3, Vector4};

use crate::error::ReadErrorKind;

/// All nodes of the scene with their world transforms, parents before children.
pub(crate) fn placed_nodes(document: &Document) -> Result<Vec<(Node<'_>, Matrix4<f64>)>, ReadErrorKind> {
    let roots: Vec<Node<'_>> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => {
            let mut is_child = vec![false; document.nodes().len()];
            for child in document.nodes().flat_map(|node| node.children().collect::<Vec<_>>()) {
                is_child[child.index()] = true;
            }
            document.nodes().filter(|node| !is_child[node.index()]).collect()
        }
    };
    let mut seen = vec![false; document.nodes().len()];
    let mut open: Vec<_> = roots.into_iter().rev().map(|root| (root, Matrix4::identity())).collect();
    let mut placed = Vec::new();
    while let Some((node, parent)) = open.pop() {
        // The format requires a tree; a cycle would never end.
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(ReadErrorKind::Malformed(format!("node {} has more than one parent", node.index())));
        }
        let world = parent * matrix_of(&node.transform());
        open.extend(node.children().collect::<Vec<_>>().into_iter().rev().map(|child| (child, world)));
        placed.push((node, world));
    }
    Ok(placed)
}

fn matrix_of(transform: &Transform) -> Matrix4<f64> {
    match transform {
        Transform::Matrix { matrix } => {
            Matrix4::from_columns(&matrix.map(|column| Vector4::from(column.map(f64::from))))
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let [x, y, z, w] = rotation.map(f64::from);
            Translation3::from(translation.map(f64::from)).to_homogeneous()
                * UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous()
                * Matrix4::new_nonuniform_scaling(&Vector3::from(scale.map(f64::from)))
        }
    }
}
