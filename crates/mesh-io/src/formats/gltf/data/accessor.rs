//! Accessors: the numbers of a glTF document.

use crate::{
    error::ReadErrorKind,
    formats::gltf::document::{Accessor, Document, compressed},
};

use super::buffers::Buffers;

/// Type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn parse(code: usize) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes of one number.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Type and number of the components of an element, for scalars and vectors; `None` for matrices and what does not
/// exist.
pub(crate) fn element(accessor: &Accessor) -> Option<(Component, usize)> {
    let count = match accessor.shape.as_str() {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => return None,
    };
    Some((Component::parse(accessor.component_type.0)?, count))
}

/// The accessors of a document with its buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accessors<'a> {
    pub(crate) document: &'a Document,
    pub(crate) buffers: &'a Buffers,
    /// The extension by which some of it may stand in a compressed form.
    pub(crate) compression: Option<&'static str>,
}

impl<'a> Accessors<'a> {
    /// Reads `count x N` numbers; integers are normalised where the accessor says so.
    pub(crate) fn read<const N: usize>(self, index: usize) -> Result<Vec<[f64; N]>, ReadErrorKind> {
        let accessor = &self.document.accessors[index];
        let kind = match element(accessor) {
            Some((kind, count)) if count == N => kind,
            _ => return Err(malformed(index, "has the wrong type, or the wrong number of components")),
        };
        let size = kind.size();
        let element = |bytes: &[u8]| -> [f64; N] {
            std::array::from_fn(|k| decode(&bytes[k * size..(k + 1) * size], kind, accessor.normalized))
        };
        self.collect(index, N * size, [0.0; N], element)
    }

    /// Reads matrices of 4 x 4 singles, column by column.
    pub(crate) fn read_matrices(self, index: usize) -> Result<Vec<[f64; 16]>, ReadErrorKind> {
        let accessor = &self.document.accessors[index];
        if accessor.shape != "MAT4" || Component::parse(accessor.component_type.0) != Some(Component::F32) {
            return Err(malformed(index, "does not hold matrices"));
        }
        let element = |bytes: &[u8]| std::array::from_fn(|k| decode(&bytes[4 * k..4 * k + 4], Component::F32, false));
        self.collect(index, 64, [0.0; 16], element)
    }

    /// Reads indices.
    pub(crate) fn read_indices(self, index: usize) -> Result<Vec<usize>, ReadErrorKind> {
        match element(&self.document.accessors[index]) {
            Some((kind @ (Component::U8 | Component::U16 | Component::U32), 1)) => {
                self.collect(index, kind.size(), 0, unsigned)
            }
            _ => Err(malformed(index, "does not hold indices")),
        }
    }

    /// Number of elements, once their bytes are known to be there. Without a buffer there are none to look for, so the
    /// caller has to bound the number.
    pub(crate) fn count(self, index: usize) -> Result<usize, ReadErrorKind> {
        let accessor = &self.document.accessors[index];
        if let Some((kind, num_components)) = element(accessor) {
            self.elements(index, num_components * kind.size())?;
        }
        Ok(accessor.count.0)
    }

    /// The bytes of an accessor's elements and their stride, if it has any and has a buffer.
    fn elements(self, index: usize, width: usize) -> Result<Option<(&'a [u8], usize)>, ReadErrorKind> {
        let Accessor { buffer_view, byte_offset, count, .. } = &self.document.accessors[index];
        let Some(view) = buffer_view.filter(|_| count.0 > 0) else { return Ok(None) };
        let view = &self.document.buffer_views[view.0];
        let stride = view.byte_stride.map_or(width, |stride| stride.0);
        if stride < width {
            return Err(malformed(index, "has elements that overlap each other: its `byteStride` is too small"));
        }
        let length = (count.0 - 1).checked_mul(stride).and_then(|length| length.checked_add(width));
        let bytes = length.and_then(|length| self.buffers.slice(view, byte_offset.0, length));
        bytes.map(|bytes| Some((bytes, stride))).ok_or_else(|| malformed(index, "reaches beyond its buffer"))
    }

    /// Decodes the elements of an accessor: a strided view, or zeros without one, with sparse replacements. The caller
    /// has bounded their number.
    fn collect<T: Clone>(
        self,
        index: usize,
        width: usize,
        zero: T,
        element: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, ReadErrorKind> {
        let Accessor { count, sparse, .. } = &self.document.accessors[index];
        let (count, views) = (count.0, &self.document.buffer_views);
        let mut values: Vec<T> = match (self.elements(index, width)?, sparse, self.compression) {
            (Some((bytes, stride)), ..) => {
                (0..count).map(|at| element(&bytes[at * stride..at * stride + width])).collect()
            }
            (None, None, Some(name)) => return Err(compressed(name)),
            (None, ..) => vec![zero; count],
        };
        let outside = || malformed(index, "reaches beyond its buffer");
        if let Some(sparse) = sparse {
            let size = match Component::parse(sparse.indices.component_type.0) {
                Some(kind @ (Component::U8 | Component::U16 | Component::U32)) => kind.size(),
                _ => return Err(malformed(index, "has sparse indices that are no whole numbers")),
            };
            let slice = |view: usize, offset, size: usize| {
                let length = sparse.count.0.checked_mul(size);
                length.and_then(|length| self.buffers.slice(&views[view], offset, length)).ok_or_else(outside)
            };
            let index_bytes = slice(sparse.indices.buffer_view.0, sparse.indices.byte_offset.0, size)?;
            let value_bytes = slice(sparse.values.buffer_view.0, sparse.values.byte_offset.0, width)?;
            for (at, bytes) in index_bytes.chunks_exact(size).zip(value_bytes.chunks_exact(width)) {
                *values.get_mut(unsigned(at)).ok_or_else(outside)? = element(bytes);
            }
        }
        Ok(values)
    }
}

fn malformed(accessor: usize, what: &str) -> ReadErrorKind {
    ReadErrorKind::Malformed(format!("accessor {accessor} {what}"))
}

/// A little-endian whole number of at most four bytes.
fn unsigned(bytes: &[u8]) -> usize {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte))
}

/// One component; normalised integers become 0..1 or -1..1.
fn decode(bytes: &[u8], kind: Component, normalized: bool) -> f64 {
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
    let (value, largest) = match kind {
        Component::I8 => (f64::from(i8::from_le_bytes([byte(0)])), 127.0),
        Component::U8 => (f64::from(byte(0)), 255.0),
        Component::I16 => (f64::from(i16::from_le_bytes([byte(0), byte(1)])), 32_767.0),
        Component::U16 => (f64::from(u16::from_le_bytes([byte(0), byte(1)])), 65_535.0),
        Component::U32 => return f64::from(u32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)])),
        Component::F32 => return f32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]).into(),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
