//! Arrays as bytes, in the machine's order.

use pyo3::{exceptions::PyValueError, prelude::*};

/// Elements of `N` numbers from the bytes of a contiguous array.
pub(crate) fn elements<T, const BYTES: usize, const N: usize>(
    name: &str,
    bytes: &[u8],
    from: impl Fn([u8; BYTES]) -> T,
) -> PyResult<Vec<[T; N]>> {
    if !bytes.len().is_multiple_of(BYTES * N) {
        let length = bytes.len();
        return Err(PyValueError::new_err(format!("{name} has {length} bytes, not a multiple of {}", BYTES * N)));
    }
    let one = |bytes: &[u8], k: usize| from(std::array::from_fn(|byte| bytes[BYTES * k + byte]));
    Ok(bytes.chunks_exact(BYTES * N).map(|bytes| std::array::from_fn(|k| one(bytes, k))).collect())
}

pub(crate) fn u32s<const N: usize>(name: &str, bytes: &[u8]) -> PyResult<Vec<[u32; N]>> {
    elements(name, bytes, u32::from_ne_bytes)
}

pub(crate) fn f64s<const N: usize>(name: &str, bytes: &[u8]) -> PyResult<Vec<[f64; N]>> {
    elements(name, bytes, f64::from_ne_bytes)
}

/// The bytes of many numbers.
pub(crate) fn of_u32s(values: impl IntoIterator<Item = u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_ne_bytes).collect()
}

/// The bytes of many numbers.
pub(crate) fn of_f64s(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_ne_bytes).collect()
}
