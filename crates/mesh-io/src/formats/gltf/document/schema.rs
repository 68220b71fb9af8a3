//! What is read of a glTF document: what positions, faces, texture coordinates, nodes and transforms need, and what
//! else uses the same data. All other members are kept in the text of the file only.

use std::collections::BTreeMap;

use serde::{Deserialize, de::IgnoredAny};

use super::numbers::{Count, Single};

/// The root of a document.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object is needed")]
pub(crate) struct Document {
    pub(crate) scene: Option<Count>,
    #[serde(default)]
    pub(crate) scenes: Vec<Scene>,
    #[serde(default)]
    pub(crate) nodes: Vec<Node>,
    #[serde(default)]
    pub(crate) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(crate) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(crate) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(crate) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(crate) images: Vec<Image>,
    #[serde(default)]
    pub(crate) skins: Vec<Skin>,
    #[serde(default)]
    pub(crate) animations: Vec<Animation>,
    #[serde(default)]
    pub(crate) extensions_used: Vec<String>,
    #[serde(default)]
    pub(crate) extensions_required: Vec<String>,
}

/// Roots of a tree of nodes.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a scene is an object")]
pub(crate) struct Scene {
    #[serde(default)]
    pub(crate) nodes: Vec<Count>,
}

/// A node: a transform, children, a mesh.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a node is an object")]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    pub(crate) mesh: Option<Count>,
    pub(crate) skin: Option<Count>,
    #[serde(default)]
    pub(crate) children: Vec<Count>,
    pub(crate) matrix: Option<[Single; 16]>,
    pub(crate) translation: Option<[Single; 3]>,
    pub(crate) rotation: Option<[Single; 4]>,
    pub(crate) scale: Option<[Single; 3]>,
    pub(crate) weights: Option<Vec<Single>>,
    #[serde(default)]
    pub(crate) extensions: NodeExtensions,
}

/// Extensions that place a mesh.
#[derive(Debug, Default, Deserialize)]
#[serde(default, expecting = "`extensions` is an object")]
pub(crate) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(crate) instancing: Option<IgnoredAny>,
}

/// A mesh of one or several primitives.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a mesh is an object")]
pub(crate) struct Mesh {
    pub(crate) name: Option<String>,
    #[serde(default)]
    pub(crate) primitives: Vec<Primitive>,
    #[serde(default)]
    pub(crate) weights: Vec<Single>,
}

/// Points, lines or triangles. Attributes are accessors by name.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a primitive is an object")]
pub(crate) struct Primitive {
    #[serde(default)]
    pub(crate) attributes: BTreeMap<String, Count>,
    pub(crate) indices: Option<Count>,
    pub(crate) mode: Option<Count>,
    #[serde(default)]
    pub(crate) targets: Vec<BTreeMap<String, Count>>,
    #[serde(default)]
    pub(crate) extensions: PrimitiveExtensions,
}

/// Extensions that hold the data of a primitive in another form.
#[derive(Debug, Default, Deserialize)]
#[serde(default, expecting = "`extensions` is an object")]
pub(crate) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(crate) draco: Option<IgnoredAny>,
}

/// A list of numbers or vectors in a view.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an accessor is an object")]
pub(crate) struct Accessor {
    pub(crate) buffer_view: Option<Count>,
    #[serde(default)]
    pub(crate) byte_offset: Count,
    pub(crate) component_type: Count,
    #[serde(default)]
    pub(crate) normalized: bool,
    pub(crate) count: Count,
    #[serde(rename = "type")]
    pub(crate) shape: String,
    pub(crate) sparse: Option<Sparse>,
}

/// Elements of an accessor that differ from those of its view.
#[derive(Debug, Deserialize)]
#[serde(expecting = "`sparse` is an object")]
pub(crate) struct Sparse {
    pub(crate) count: Count,
    pub(crate) indices: SparseIndices,
    pub(crate) values: SparseValues,
}

/// Which elements differ.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "`indices` is an object")]
pub(crate) struct SparseIndices {
    pub(crate) buffer_view: Count,
    #[serde(default)]
    pub(crate) byte_offset: Count,
    pub(crate) component_type: Count,
}

/// What they are instead.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "`values` is an object")]
pub(crate) struct SparseValues {
    pub(crate) buffer_view: Count,
    #[serde(default)]
    pub(crate) byte_offset: Count,
}

/// A run of bytes in a buffer.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "a buffer view is an object")]
pub(crate) struct BufferView {
    pub(crate) buffer: Count,
    #[serde(default)]
    pub(crate) byte_offset: Count,
    pub(crate) byte_length: Count,
    pub(crate) byte_stride: Option<Count>,
    #[serde(default)]
    pub(crate) extensions: ViewExtensions,
}

/// Extensions that hold the bytes of a view in another form.
#[derive(Debug, Default, Deserialize)]
#[serde(default, expecting = "`extensions` is an object")]
pub(crate) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub(crate) meshopt: Option<IgnoredAny>,
}

/// Bytes: of the binary chunk, of a `data:` link or of another file.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "a buffer is an object")]
pub(crate) struct Buffer {
    pub(crate) byte_length: Count,
    pub(crate) uri: Option<String>,
}

/// An image; only whether it stands in a view is of interest. Image files are not read.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an image is an object")]
pub(crate) struct Image {
    pub(crate) buffer_view: Option<Count>,
}

/// A skin.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", expecting = "a skin is an object")]
pub(crate) struct Skin {
    #[serde(default)]
    pub(crate) joints: Vec<Count>,
    pub(crate) inverse_bind_matrices: Option<Count>,
}

/// An animation.
#[derive(Debug, Deserialize)]
#[serde(expecting = "an animation is an object")]
pub(crate) struct Animation {
    #[serde(default)]
    pub(crate) samplers: Vec<Sampler>,
}

/// Times and values of an animation, as accessors.
#[derive(Debug, Deserialize)]
#[serde(expecting = "a sampler is an object")]
pub(crate) struct Sampler {
    pub(crate) input: Option<Count>,
    pub(crate) output: Option<Count>,
}
