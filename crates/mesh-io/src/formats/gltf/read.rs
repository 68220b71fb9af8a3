//! Reading glTF.

use std::{collections::HashMap, ops::Range, path::Path};

use gltf::{Accessor, Document, Node, Primitive, Semantic, mesh::Mode};
use nalgebra::{Matrix4, Vector4};

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        part::{PartBuilder, PartName},
        polygon::NO_UV,
    },
};

use super::{
    accessor,
    buffers::Buffers,
    container::Chunks,
    nodes::placed_nodes,
    place::Place,
    write::{Block, GltfDocument},
};

/// Parses a whole file. Links to buffers are relative to `folder`.
pub(crate) fn parse(source: Vec<u8>, folder: Option<&Path>) -> Result<(MeshData, GltfDocument), ReadErrorKind> {
    // The crate `gltf` subtracts the length of the header from the length that a binary file claims, unchecked.
    if let Some(&[b'g', b'l', b'T', b'F', _, _, _, _, a, b, c, d]) = source.first_chunk::<12>()
        && u32::from_le_bytes([a, b, c, d]) < 12
    {
        return Err(ReadErrorKind::Malformed("the header says that the file is shorter than its header".into()));
    }
    // Its arithmetic on claimed lengths is unchecked elsewhere too, and panics in debug builds.
    let read = std::panic::catch_unwind(|| ::gltf::Gltf::from_slice(&source));
    let ::gltf::Gltf { document, blob } =
        read.map_err(|_| ReadErrorKind::Malformed("lengths in it contradict each other".into()))??;
    let chunks = Chunks::find(&source).ok_or_else(|| ReadErrorKind::Truncated { element: "a chunk".into() })?;
    let buffers = Buffers::load(&document, folder, blob)?;
    let mut builder = Builder {
        document: &document,
        buffers: &buffers,
        data: MeshData::default(),
        blocks: Vec::new(),
        parts: PartBuilder::default(),
    };
    for (node, transform) in placed_nodes(&document)? {
        builder.node(&node, &transform)?;
    }
    let Builder { mut data, blocks, parts, .. } = builder;
    data.parts = parts.finish(data.polygons.len(), data.positions.len());
    Ok((data, GltfDocument { source, chunks, buffers, blocks }))
}

/// Collects the geometry of all nodes.
struct Builder<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    data: MeshData,
    blocks: Vec<Block>,
    parts: PartBuilder,
}

impl Builder<'_> {
    /// Adds the mesh of a node, if it has one.
    fn node(&mut self, node: &Node<'_>, transform: &Matrix4<f64>) -> Result<(), ReadErrorKind> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let name = |kind, name: Option<&str>| name.map(|name| PartName { kind, name: name.into() });
        self.parts.rename(self.data.polygons.len(), self.data.positions.len(), |part| {
            (part.outer, part.inner) = (name("node", node.name()), name("mesh", mesh.name()));
        });
        // The first vertex of each accessor of positions that this node uses. Never iterated.
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
                    let vertices = self.positions(&accessor, transform, &name)?;
                    let first = vertices.start;
                    first_vertices.insert(accessor.index(), first);
                    let place = Place::new(self.document, node, &accessor, transform);
                    self.blocks.push(Block { vertices, place });
                    first
                }
            };
            self.primitive(&primitive, &name, first_vertex, accessor.count())?;
        }
        Ok(())
    }

    /// Adds the positions of an accessor, transformed to the world. Returns their vertices.
    fn positions(
        &mut self,
        accessor: &Accessor<'_>,
        transform: &Matrix4<f64>,
        name: &str,
    ) -> Result<Range<usize>, ReadErrorKind> {
        let first = self.data.positions.len();
        for [x, y, z] in accessor::read::<3>(accessor, self.buffers)? {
            let world = transform * Vector4::new(x, y, z, 1.0);
            let position = [world.x, world.y, world.z];
            if let Some(&value) = position.iter().find(|value| !value.is_finite()) {
                let element = format!("{name}, vertex {}", self.data.positions.len() - first);
                return Err(ReadErrorKind::NotFinite { element, value });
            }
            self.data.positions.push(position);
        }
        Ok(first..self.data.positions.len())
    }

    /// Adds the triangles of a primitive, and its texture coordinates if all are finite.
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
                first_uv = Some(self.data.uv_coordinates.len());
                self.data.uv_coordinates.extend(uvs);
            }
        }
        let id = |index: usize| u32::try_from(index).ok().filter(|&id| id != NO_UV);
        let too_many = || ReadErrorKind::Malformed("more vertices than 32-bit indices can name".into());
        for triangle in triangles(primitive.mode(), &indices) {
            for index in triangle {
                let vertex = id(first_vertex + index).ok_or_else(too_many)?;
                let uv = first_uv.map_or(Some(NO_UV), |first| id(first + index)).ok_or_else(too_many)?;
                self.data.polygons.push_corner(vertex, uv);
            }
            self.data.polygons.finish_polygon();
        }
        Ok(())
    }
}

/// The triangles of a list, strip or fan, all of the same orientation.
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
