//! A digest, and what can be taken into one.

/// FNV-1a hash of 64 bits (Fowler, Noll and Vo).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(pub u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Takes some bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Values that a digest can be taken of. Structures are destructured in full: a new field stops the build until fed.
pub trait Feed {
    /// Feeds all numbers of a value into `digest`.
    fn feed(&self, digest: &mut Digest);
}
