//! Elements of an array that crosses the network, and what they are at rest.

use untangled_proto::{PositionF32, PositionF64, VertexCorrection, flags};

use crate::plain::{self, Plain};

/// Elements that may be at rest.
pub trait Element: Plain {
    /// An element at rest, pinned or not.
    fn rest(pinned: bool) -> Self;

    /// Whether it says that its vertex is pinned.
    fn is_pinned(&self) -> bool;

    /// Whether it is at rest, to the bit.
    fn is_rest(&self, pinned: bool) -> bool {
        plain::bytes_of(std::slice::from_ref(self)) == plain::bytes_of(&[Self::rest(pinned)])
    }
}

impl Element for VertexCorrection {
    fn rest(pinned: bool) -> Self {
        Self { value: [0.0; 3], flags: if pinned { flags::PINNED } else { 0 } }
    }

    fn is_pinned(&self) -> bool {
        self.flags & flags::PINNED != 0
    }
}

impl Element for PositionF32 {
    fn rest(_: bool) -> Self {
        Self([0.0; 3])
    }

    fn is_pinned(&self) -> bool {
        false
    }
}

impl Element for PositionF64 {
    fn rest(_: bool) -> Self {
        Self([0.0; 3])
    }

    fn is_pinned(&self) -> bool {
        false
    }
}
