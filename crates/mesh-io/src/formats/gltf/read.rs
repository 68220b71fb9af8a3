//! Reading glTF.

use std::{collections::HashMap, ops::Range, path::Path};

use nalgebra::Matrix4;

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        part::{PartBuilder, PartName},
        polygon::NO_UV,
    },
};

use super::{
    container::Chunks,
    data::{Budget, Buffers, accessor::Accessors},
    document::{self, Document, Primitive},
    json::Spans,
    nodes::{placed_nodes, to_world},
    place::Place,
    rest::Rest,
    usage::Usage,
    write::{Block, GltfDocument},
};

/// Parses a whole file. Links to buffers are relative to `folder`.
pub(crate) fn parse(source: Vec<u8>, folder: &Path) -> Result<(MeshData, GltfDocument), ReadErrorKind> {
    let chunks = Chunks::find(&source)?;
    let json = &source[chunks.json.clone()];
    let document = document::parse(json)?;
    // What could not be edited is refused before any work is done.
    Spans::find(json).map_err(|error| ReadErrorKind::Gltf(error.to_string()))?;
    let buffers = Buffers::load(&document, folder, chunks.binary.clone().map(|range| &source[range]))?;
    let mut builder = Builder {
        document: &document,
        usage: Usage::of(&document),
        accessors: Accessors { document: &document, buffers: &buffers, compression: document::compression(&document) },
        budget: Budget::new(source.len() + buffers.num_linked_bytes()),
        data: MeshData::default(),
        blocks: Vec::new(),
        parts: PartBuilder::default(),
    };
    let placed = placed_nodes(&document)?;
    let transforms = placed.iter().copied().collect();
    for (node, _) in placed {
        builder.node(node, &transforms)?;
    }
    let Builder { mut data, blocks, parts, .. } = builder;
    data.parts = parts.finish(data.polygons.len(), data.positions.len());
    Ok((data, GltfDocument { source, chunks, buffers, blocks }))
}

/// Bytes of a position, of texture coordinates and of a corner in memory, and of a primitive with its names and places.
const POSITION: usize = 24;
const UV: usize = 16;
const CORNER: usize = 4;
const PRIMITIVE: usize = 128;

/// How the corners of a primitive make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// Collects the geometry of all nodes.
struct Builder<'a> {
    document: &'a Document,
    usage: Usage,
    accessors: Accessors<'a>,
    budget: Budget,
    data: MeshData,
    blocks: Vec<Block>,
    parts: PartBuilder,
}

impl Builder<'_> {
    /// Adds the mesh of a node, if it has one.
    fn node(&mut self, node: usize, placed: &HashMap<usize, Matrix4<f64>>) -> Result<(), ReadErrorKind> {
        let Some(mesh) = self.document.nodes[node].mesh else { return Ok(()) };
        let (number, mesh) = (mesh.0, &self.document.meshes[mesh.0]);
        let name = |kind, name: &Option<String>| name.as_deref().map(|name| PartName { kind, name: name.into() });
        let (outer, inner) = (name("node", &self.document.nodes[node].name), name("mesh", &mesh.name));
        self.budget.take(1, PRIMITIVE + inner.as_ref().map_or(0, |inner| inner.name.len()))?;
        self.parts.rename(self.data.polygons.len(), self.data.positions.len(), |part| {
            (part.outer, part.inner) = (outer, inner);
        });
        let rest = Rest::of(node, placed, self.accessors, &mut self.budget)?;
        // The first vertex of each accessor of positions that this node uses. Never iterated.
        let mut first_vertices: HashMap<usize, usize> = HashMap::new();
        for (at, primitive) in mesh.primitives.iter().enumerate() {
            self.budget.take(1, PRIMITIVE)?;
            let name = format!("mesh {number}, primitive {at}");
            let mode = match primitive.mode.map_or(4, |mode| mode.0) {
                0..=3 => continue,
                4 => Mode::Triangles,
                5 => Mode::Strip,
                6 => Mode::Fan,
                mode => return Err(ReadErrorKind::Gltf(format!("{name} has mode {mode}, which does not exist"))),
            };
            let Some(accessor) = primitive.attributes.get("POSITION").map(|accessor| accessor.0) else {
                return Err(ReadErrorKind::Malformed(format!("{name} has no positions")));
            };
            let first_vertex = match first_vertices.get(&accessor) {
                Some(&first) => first,
                None => {
                    let vertices = self.positions(accessor, &rest, primitive, &name)?;
                    let first = vertices.start;
                    first_vertices.insert(accessor, first);
                    let place =
                        Place::new(self.document, &self.usage, self.accessors.compression, [node, accessor], &rest);
                    self.blocks.push(Block { vertices, place });
                    first
                }
            };
            self.primitive((primitive, mode), &name, first_vertex, self.document.accessors[accessor].count.0)?;
        }
        Ok(())
    }

    /// Adds the positions of an accessor, transformed to the world. Returns their vertices.
    fn positions(
        &mut self,
        accessor: usize,
        rest: &Rest,
        primitive: &Primitive,
        name: &str,
    ) -> Result<Range<usize>, ReadErrorKind> {
        let first = self.data.positions.len();
        self.budget.take(self.accessors.count(accessor)?, POSITION)?;
        let mut stored = self.accessors.read::<3>(accessor)?;
        let is_in_world = rest.apply(primitive, name, &mut stored, self.accessors, &mut self.budget)?;
        for stored in stored {
            let position = if is_in_world { stored } else { to_world(&rest.to_world, stored) };
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
        (primitive, mode): (&Primitive, Mode),
        name: &str,
        first_vertex: usize,
        num_vertices: usize,
    ) -> Result<(), ReadErrorKind> {
        let num_indices = match primitive.indices {
            Some(accessor) => self.accessors.count(accessor.0)?,
            None => num_vertices,
        };
        let num_corners = if mode == Mode::Triangles { num_indices } else { num_indices.saturating_mul(3) };
        self.budget.take(num_corners, CORNER)?;
        let indices: Vec<usize> = match primitive.indices {
            Some(accessor) => self.accessors.read_indices(accessor.0)?,
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
        if let Some(accessor) = primitive.attributes.get("TEXCOORD_0") {
            self.budget.take(self.accessors.count(accessor.0)?, UV)?;
            let uvs = self.accessors.read::<2>(accessor.0)?;
            if uvs.len() >= num_vertices && uvs.iter().flatten().all(|uv| uv.is_finite()) {
                first_uv = Some(self.data.uv_coordinates.len());
                self.data.uv_coordinates.extend(uvs);
            }
        }
        let id = |index: usize| u32::try_from(index).ok().filter(|&id| id != NO_UV);
        let too_many = || ReadErrorKind::Malformed("more vertices than 32-bit indices can name".into());
        for triangle in triangles(mode, &indices) {
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
        Mode::Strip => indices
            .windows(3)
            .enumerate()
            .map(|(at, corners)| {
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                if at % 2 == 0 { [a, b, c] } else { [b, a, c] }
            })
            .collect(),
        Mode::Fan => indices.windows(2).skip(1).map(|corners| [indices[0], corners[0], corners[1]]).collect(),
        Mode::Triangles => indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
    }
}
