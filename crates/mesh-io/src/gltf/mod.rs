//! glTF 2.0, as `.gltf` with its buffers or as `.glb`.
//!
//! All triangles of the default scene (or of the first one, or else of all nodes), each mesh where its node puts it, node by node in
//! the order of the tree. Primitives of a node that use the same positions share their vertices; nothing else is merged, so a
//! mesh that its exporter split along texture seams stays split. Morph targets and skins are not applied; points and lines are left
//! out. Coordinates are stored in single precision; nodes are applied in double.
//!
//! Written back, positions are replaced in their buffer and the text changes only where it must. Positions can't move that stand in the file
//! in another way than one list of singles for one node: see `place`.

mod accessor;
mod buffers;
mod container;
mod json;
mod place;
mod write;

use std::{collections::HashMap, path::Path};

use gltf::{Document, Node, Primitive, Semantic, mesh::Mode, scene::Transform};
use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3, Vector4};

use super::{ReadErrorKind, mesh_file::Parsed, polygon::NO_UV};
use buffers::Buffers;
use container::Chunks;
use place::Place;
use write::Block;

pub(super) use container::Container;
pub(super) use write::GltfDocument;

/// Parses a whole file; buffers of their own are looked for in `folder`.
pub(super) fn parse(source: Vec<u8>, folder: Option<&Path>) -> Result<(Parsed, GltfDocument), ReadErrorKind> {
    // The reader takes the length of the header from the length that a binary file claims, unchecked.
    if let Some(&[b'g', b'l', b'T', b'F', _, _, _, _, a, b, c, d]) = source.first_chunk::<12>()
        && u32::from_le_bytes([a, b, c, d]) < 12
    {
        return Err(ReadErrorKind::Malformed("the header says that the file is shorter than its header".into()));
    }
    // Its arithmetic on lengths that a file claims is unchecked elsewhere too, which debug builds turn into panics.
    let read = std::panic::catch_unwind(|| ::gltf::Gltf::from_slice(&source));
    let ::gltf::Gltf { document, blob } =
        read.map_err(|_| ReadErrorKind::Malformed("lengths in it contradict each other".into()))??;
    let chunks = Chunks::find(&source).ok_or_else(|| ReadErrorKind::Truncated { element: "a chunk".into() })?;
    let buffers = Buffers::load(&document, folder, blob)?;
    let mut builder = Builder { document: &document, buffers: &buffers, parsed: Parsed::default(), blocks: Vec::new() };
    for (node, transform) in placed_nodes(&document)? {
        builder.node(&node, &transform)?;
    }
    let Builder { parsed, blocks, .. } = builder;
    Ok((parsed, GltfDocument { source, chunks, buffers, blocks }))
}

/// All nodes of the scene with their world transforms, parents before children.
fn placed_nodes(document: &Document) -> Result<Vec<(Node<'_>, Matrix4<f64>)>, ReadErrorKind> {
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
        // The format asks for a tree; a cycle would never end.
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

struct Builder<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    parsed: Parsed,
    blocks: Vec<Block>,
}

impl Builder<'_> {
    fn node(&mut self, node: &Node<'_>, transform: &Matrix4<f64>) -> Result<(), ReadErrorKind> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        // First vertex of each accessor of positions in use at this node. Only looked up, never iterated.
        let mut first_vertices: HashMap<usize, usize> = HashMap::new();
        for primitive in mesh.primitives() {
            if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                continue;
            }
            let name = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
            let Some(accessor) = primitive.get(&Semantic::Positions) else {
                return Err(ReadErrorKind::Malformed(format!("{name} has no positions")));
            };
            let first_vertex = match first_vertices.get(&accessor.index()) {
                Some(&first) => first,
                None => {
                    let first = self.parsed.positions.len();
                    for point in accessor::read::<3>(&accessor, self.buffers)? {
                        let [x, y, z] = point;
                        let world = transform * Vector4::new(x, y, z, 1.0);
                        let position = [world.x, world.y, world.z];
                        if let Some(&value) = position.iter().find(|value| !value.is_finite()) {
                            let element = format!("{name}, vertex {}", self.parsed.positions.len() - first);
                            return Err(ReadErrorKind::NotFinite { element, value });
                        }
                        self.parsed.positions.push(position);
                    }
                    first_vertices.insert(accessor.index(), first);
                    let vertices = first..self.parsed.positions.len();
                    let place = Place::new(self.document, node, &accessor, transform);
                    self.blocks.push(Block { vertices, place });
                    first
                }
            };
            self.primitive(&primitive, &name, first_vertex, accessor.count())?;
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        primitive: &Primitive<'_>,
        name: &str,
        first_vertex: usize,
        num_vertices: usize,
    ) -> Result<(), ReadErrorKind> {
        let indices: Vec<usize> = match primitive.indices() {
            Some(accessor) => accessor::read_indices(&accessor, self.buffers)?,
            None => (0..num_vertices).collect(),
        };
        if let Some(&index) = indices.iter().find(|&&index| index >= num_vertices) {
            let index = i64::try_from(index).unwrap_or(i64::MAX);
            return Err(ReadErrorKind::OutOfRange {
                element: name.to_string(),
                what: "vertex",
                index,
                defined: num_vertices,
            });
        }
        let mut first_uv = None;
        if let Some(accessor) = primitive.get(&Semantic::TexCoords(0)) {
            let uvs = accessor::read::<2>(&accessor, self.buffers)?;
            if uvs.len() >= num_vertices && uvs.iter().flatten().all(|uv| uv.is_finite()) {
                first_uv = Some(self.parsed.uv_coordinates.len());
                self.parsed.uv_coordinates.extend(uvs);
            }
        }
        let id = |index: usize| u32::try_from(index).ok().filter(|&id| id != NO_UV);
        let too_many = || ReadErrorKind::Malformed("more vertices than 32-bit indices can name".into());
        for triangle in triangles(primitive.mode(), &indices) {
            for index in triangle {
                let vertex = id(first_vertex + index).ok_or_else(too_many)?;
                let uv = first_uv.map_or(Some(NO_UV), |first| id(first + index)).ok_or_else(too_many)?;
                self.parsed.polygons.push_corner(vertex, uv);
            }
            self.parsed.polygons.finish_polygon();
        }
        Ok(())
    }
}

/// The triangles of a list, strip or fan, all of one orientation.
fn triangles(mode: Mode, indices: &[usize]) -> Vec<[usize; 3]> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(at, corners)| {
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                if at % 2 == 0 { [a, b, c] } else { [b, a, c] }
            })
            .collect(),
        Mode::TriangleFan => indices.windows(2).skip(1).map(|corners| [indices[0], corners[0], corners[1]]).collect(),
        _ => indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
    }
}

#[cfg(test)]
mod tests;
