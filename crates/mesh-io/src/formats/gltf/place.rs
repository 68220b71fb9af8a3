//! The place of a node's positions in a buffer, and the reasons why some positions can't be replaced there.

use gltf::{Accessor, Document, Node, Semantic, accessor::DataType};
use nalgebra::{Matrix4, RowVector4, Vector4};

/// Positions in a buffer that may be replaced, each of three little-endian singles.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) accessor: usize,
    pub(crate) bytes: Bytes,
    from_world: Matrix4<f64>,
    /// Whether the stored coordinates are world coordinates.
    pub(crate) is_identity: bool,
}

/// The bytes of an accessor: `count` elements of `width`, `stride` apart, of which the first starts at `start`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bytes {
    pub(crate) buffer: usize,
    pub(crate) start: usize,
    pub(crate) stride: usize,
    pub(crate) width: usize,
    pub(crate) count: usize,
}

impl Place {
    /// The place of a node's positions, or the reason why they can't be replaced.
    pub(crate) fn new(
        document: &Document,
        node: &Node<'_>,
        accessor: &Accessor<'_>,
        to_world: &Matrix4<f64>,
    ) -> Result<Self, String> {
        if let Some(name) = document.extensions_used().find(|name| COMPRESSIONS.contains(name)) {
            return Err(format!("the document uses {name}"));
        }
        if node.skin().is_some() {
            return Err(format!("node {} is skinned", node.index()));
        }
        let mesh = node.mesh().map(|mesh| mesh.index());
        if document.nodes().filter(|other| other.mesh().map(|mesh| mesh.index()) == mesh).count() > 1 {
            return Err(format!("mesh {} is used by more than one node", mesh.unwrap_or_default()));
        }
        let index = accessor.index();
        if accessor.sparse().is_some() {
            return Err(format!("accessor {index} is sparse"));
        }
        if accessor.data_type() != DataType::F32 {
            return Err(format!("accessor {index} is quantised"));
        }
        let Some(bytes) = Bytes::of(accessor) else {
            return Err(format!("accessor {index} has no buffer"));
        };
        if is_used_otherwise(document, index, mesh) {
            return Err(format!("accessor {index} is used by something else too"));
        }
        let mut others = document.accessors().filter(|other| other.index() != index);
        if let Some(other) = others.find(|other| Bytes::of(other).is_some_and(|other| bytes.overlaps(&other))) {
            return Err(format!("accessors {index} and {} share bytes", other.index()));
        }
        let inverse = to_world.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()));
        match inverse {
            Some(from_world) if to_world.row(3) == RowVector4::new(0.0, 0.0, 0.0, 1.0) => {
                Ok(Self { accessor: index, bytes, from_world, is_identity: *to_world == Matrix4::identity() })
            }
            _ => Err(format!("the transform of node {} can't be inverted", node.index())),
        }
    }

    /// A world position as it is stored; `None` if it is beyond single precision.
    pub(crate) fn stored(&self, [x, y, z]: [f64; 3]) -> Option<[f32; 3]> {
        let local = self.from_world * Vector4::new(x, y, z, 1.0);
        #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
        let stored = [local.x as f32, local.y as f32, local.z as f32];
        stored.iter().all(|value| value.is_finite()).then_some(stored)
    }
}

/// Extensions that hold positions in a second, compressed form.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Whether an accessor is anything but the positions of one mesh.
fn is_used_otherwise(document: &Document, accessor: usize, mesh: Option<usize>) -> bool {
    let is = |other: Option<Accessor<'_>>| other.is_some_and(|other| other.index() == accessor);
    let in_meshes = document.meshes().any(|other| {
        other.primitives().any(|primitive| {
            let own = |semantic: &Semantic| *semantic == Semantic::Positions && Some(other.index()) == mesh;
            primitive.attributes().any(|(semantic, attribute)| attribute.index() == accessor && !own(&semantic))
                || is(primitive.indices())
                || primitive
                    .morph_targets()
                    .any(|target| is(target.positions()) || is(target.normals()) || is(target.tangents()))
        })
    });
    let in_skins = document.skins().any(|skin| is(skin.inverse_bind_matrices()));
    let in_animations = document.animations().any(|animation| {
        animation.samplers().any(|sampler| [sampler.input().index(), sampler.output().index()].contains(&accessor))
    });
    in_meshes || in_skins || in_animations
}

impl Bytes {
    /// The bytes of an accessor; `None` without elements or without a buffer.
    fn of(accessor: &Accessor<'_>) -> Option<Self> {
        let view = accessor.view()?;
        let width = accessor.size();
        let (start, count) = (view.offset().checked_add(accessor.offset())?, accessor.count());
        let stride = view.stride().unwrap_or(width).max(width);
        (count > 0 && width > 0).then_some(Self { buffer: view.buffer().index(), start, stride, width, count })
    }

    fn end(&self) -> usize {
        self.start.saturating_add((self.count - 1).saturating_mul(self.stride)).saturating_add(self.width)
    }

    /// Whether the two share a byte; interleaved attributes share none.
    fn overlaps(&self, other: &Self) -> bool {
        if self.buffer != other.buffer || self.start >= other.end() || other.start >= self.end() {
            return false;
        }
        if self.stride != other.stride {
            return true;
        }
        let stride = self.stride;
        let shift = (other.start % stride + stride - self.start % stride) % stride;
        shift < self.width || shift + other.width > stride
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_interleaved_attributes_do_not_overlap() {
        let bytes = |start, stride, width| Bytes { buffer: 0, start, stride, width, count: 10 };
        let positions = bytes(4, 32, 12);
        for (other, expected) in [
            (bytes(16, 32, 12), false),
            (bytes(28, 32, 8), false),
            (bytes(0, 32, 4), false),
            (bytes(28, 32, 12), true),
            (bytes(12, 32, 4), true),
            (bytes(0, 12, 12), true),
            (bytes(4 + 9 * 32 + 12, 12, 12), false),
            (Bytes { buffer: 1, ..positions }, false),
        ] {
            assert_eq!((positions.overlaps(&other), other.overlaps(&positions)), (expected, expected), "{other:?}");
        }
    }
}
