//! How much mesh a document may ask for.

use crate::error::ReadErrorKind;

/// Bytes of mesh, as it is in memory, that a document may ask for with each byte of its own and of its buffers.
///
/// Accessors without a buffer, sparse accessors and meshes of several nodes make many vertices out of few bytes. Without
/// any of these a document asks for 12 at most (a strip of 8-bit indices); the rest is for meshes that stand at several
/// nodes.
const MOST_BYTES_OF_MESH: usize = 64;

/// What is left of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    left: usize,
    num_bytes: usize,
}

impl Budget {
    /// The budget of a document of `num_bytes`, those of its buffers included.
    pub(crate) fn new(num_bytes: usize) -> Self {
        Self { left: num_bytes.saturating_mul(MOST_BYTES_OF_MESH), num_bytes }
    }

    /// Takes `count` elements of `size` bytes, before memory is taken for them.
    ///
    /// # Errors
    /// [`ReadErrorKind::Amplified`].
    pub(crate) fn take(&mut self, count: usize, size: usize) -> Result<(), ReadErrorKind> {
        let refused = ReadErrorKind::Amplified { num_bytes: self.num_bytes, factor: MOST_BYTES_OF_MESH };
        let left = count.checked_mul(size).and_then(|bytes| self.left.checked_sub(bytes));
        self.left = left.ok_or(refused)?;
        Ok(())
    }
}
