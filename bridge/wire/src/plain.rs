//! Wire structs as bytes, and back: they are passed on as they are, so that a field that they gain needs no change
//! here.

use untangled_proto::{
    CorrectionHeader, PositionF32, PositionF64, RepairHeader, ReplyHeader, RequestHeader, StateHeader,
    VertexCorrection, paths::PathsHeader,
};

/// Structs that are nothing but their bytes.
///
/// # Safety
/// The type has no padding, and every pattern of bits is a valid value of it.
pub unsafe trait Plain: Copy + 'static {}

macro_rules! plain {
    ($($name:ty),*) => {
        $(
            // SAFETY: repr(C) of numbers whose sizes add up to that of the struct (`proto/tests/layout.rs` pins both),
            // or a number itself.
            unsafe impl Plain for $name {}
        )*
    };
}

plain!(StateHeader, CorrectionHeader, RepairHeader, PathsHeader, RequestHeader, ReplyHeader);
plain!(VertexCorrection, PositionF32, PositionF64, u32, u8);

/// The bytes of values, in place.
pub fn bytes_of<T: Plain>(values: &[T]) -> &[u8] {
    // SAFETY: `T` has no padding, so each of its bytes has a value.
    unsafe { std::slice::from_raw_parts(values.as_ptr().cast(), size_of_val(values)) }
}

/// The value with these bytes; nothing where they are more or fewer than it has.
pub fn from_bytes<T: Plain>(bytes: &[u8]) -> Option<T> {
    if bytes.len() != size_of::<T>() {
        return None;
    }
    // SAFETY: there are as many bytes as the value has, any of them make a valid one, and the read asks for no
    // alignment.
    Some(unsafe { bytes.as_ptr().cast::<T>().read_unaligned() })
}

/// The value at the front of `bytes`, and what follows it.
pub fn split_front<T: Plain>(bytes: &[u8]) -> Option<(T, &[u8])> {
    let (front, rest) = bytes.split_at_checked(size_of::<T>())?;
    Some((from_bytes(front)?, rest))
}

/// The values that `bytes` hold, one after the other; nothing where the last one is not whole.
pub fn values<T: Plain>(bytes: &[u8]) -> Option<impl ExactSizeIterator<Item = T> + '_> {
    let chunks = bytes.chunks_exact(size_of::<T>());
    let is_whole = chunks.remainder().is_empty();
    // Each chunk has the size of a value.
    is_whole.then(|| {
        chunks.map(|chunk| {
            // SAFETY: as in `from_bytes`: the chunk has as many bytes as the value.
            unsafe { chunk.as_ptr().cast::<T>().read_unaligned() }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_headers_come_back_and_wrong_lengths_are_refused() {
        let header = StateHeader { frame: 7, dt_s: 0.25, reserved: 9, ..StateHeader::default() };
        let bytes = bytes_of(&[header]).to_vec();
        assert_eq!(from_bytes::<StateHeader>(&bytes), Some(header));
        assert_eq!(from_bytes::<StateHeader>(&bytes[1..]), None);
        assert_eq!(split_front::<u32>(&[1, 0, 0, 0, 5]), Some((1, &[5][..])));
        assert_eq!(split_front::<u32>(&[1, 0, 0]), None);
        let words = [3u32, 0xffff_0000];
        assert!(values::<u32>(bytes_of(&words)).unwrap().eq(words));
        assert!(values::<u32>(&[0; 5]).is_none());
    }
}
