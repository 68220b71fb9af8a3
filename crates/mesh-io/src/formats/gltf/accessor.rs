//! Accessors: the numbers of a glTF document, with every bound checked, since a document is not trusted about its
//! buffers.

use gltf::{
    Accessor,
    accessor::{DataType, sparse::IndexType},
};

use crate::error::ReadErrorKind;

use super::buffers::Buffers;

/// Reads `count x N` numbers; integers are normalised where the accessor says so.
pub(crate) fn read<const N: usize>(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<[f64; N]>, ReadErrorKind> {
    let kind = accessor.data_type();
    let width = N * size_of_type(kind);
    if accessor.dimensions().multiplicity() != N {
        return Err(malformed(accessor, "has the wrong number of components"));
    }
    let element = |bytes: &[u8]| -> [f64; N] {
        let size = width / N;
        std::array::from_fn(|k| decode(&bytes[k * size..(k + 1) * size], kind, accessor.normalized()))
    };
    collect(accessor, buffers, width, [0.0; N], element)
}

/// Reads indices.
pub(crate) fn read_indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<usize>, ReadErrorKind> {
    let kind = accessor.data_type();
    if accessor.dimensions().multiplicity() != 1 || !matches!(kind, DataType::U8 | DataType::U16 | DataType::U32) {
        return Err(malformed(accessor, "does not hold indices"));
    }
    collect(accessor, buffers, size_of_type(kind), 0, unsigned)
}

/// Decodes the elements of an accessor: a strided view, or zeros without one, with sparse replacements.
fn collect<T: Clone>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
    width: usize,
    zero: T,
    element: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, ReadErrorKind> {
    let count = accessor.count();
    if count == 0 {
        return Ok(Vec::new());
    }
    let outside = || malformed(accessor, "reaches beyond its buffer");
    let mut values = match accessor.view() {
        Some(view) => {
            let stride = view.stride().unwrap_or(width).max(width);
            let length = (count - 1).checked_mul(stride).and_then(|length| length.checked_add(width));
            let bytes =
                length.and_then(|length| buffers.slice(&view, accessor.offset(), length)).ok_or_else(outside)?;
            (0..count).map(|at| element(&bytes[at * stride..at * stride + width])).collect()
        }
        // Zeros take no bytes in the file, so no buffer limits their number.
        None if count <= 1 << 24 => vec![zero; count],
        None => return Err(malformed(accessor, "has too many elements without a buffer")),
    };
    if let Some(sparse) = accessor.sparse() {
        let (indices, replacements) = (sparse.indices(), sparse.values());
        let size = match indices.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let slice = |view, offset, size: usize| {
            sparse.count().checked_mul(size).and_then(|length| buffers.slice(&view, offset, length)).ok_or_else(outside)
        };
        let index_bytes = slice(indices.view(), indices.offset(), size)?;
        let value_bytes = slice(replacements.view(), replacements.offset(), width)?;
        for (index, bytes) in index_bytes.chunks_exact(size).zip(value_bytes.chunks_exact(width)) {
            *values.get_mut(unsigned(index)).ok_or_else(outside)? = element(bytes);
        }
    }
    Ok(values)
}

fn malformed(accessor: &Accessor<'_>, what: &str) -> ReadErrorKind {
    ReadErrorKind::Malformed(format!("accessor {} {what}", accessor.index()))
}

fn size_of_type(kind: DataType) -> usize {
    match kind {
        DataType::I8 | DataType::U8 => 1,
        DataType::I16 | DataType::U16 => 2,
        DataType::U32 | DataType::F32 => 4,
    }
}

/// A little-endian whole number of at most four bytes.
fn unsigned(bytes: &[u8]) -> usize {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte))
}

/// One component; normalised integers become 0..1 or -1..1.
fn decode(bytes: &[u8], kind: DataType, normalized: bool) -> f64 {
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
    let (value, largest) = match kind {
        DataType::I8 => (f64::from(i8::from_le_bytes([byte(0)])), 127.0),
        DataType::U8 => (f64::from(byte(0)), 255.0),
        DataType::I16 => (f64::from(i16::from_le_bytes([byte(0), byte(1)])), 32_767.0),
        DataType::U16 => (f64::from(u16::from_le_bytes([byte(0), byte(1)])), 65_535.0),
        DataType::U32 => return f64::from(u32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)])),
        DataType::F32 => return f32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]).into(),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
