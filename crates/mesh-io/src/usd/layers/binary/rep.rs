//! The representation of a value in a crate file: a type, flags, and a number that is the value itself or says where it
//! is.

/// The representation of a value.
#[derive(Clone, Copy)]
pub(super) struct Rep(pub(super) u64);

/// Types by their number in the file.
pub(super) mod kind {
    pub(in super::super) const BOOL: u8 = 1;
    pub(in super::super) const INT: u8 = 3;
    pub(in super::super) const UINT: u8 = 4;
    pub(in super::super) const INT64: u8 = 5;
    pub(in super::super) const UINT64: u8 = 6;
    pub(in super::super) const FLOAT: u8 = 8;
    pub(in super::super) const DOUBLE: u8 = 9;
    pub(in super::super) const STRING: u8 = 10;
    pub(in super::super) const TOKEN: u8 = 11;
    pub(in super::super) const ASSET_PATH: u8 = 12;
    pub(in super::super) const MATRIX4D: u8 = 15;
    pub(in super::super) const QUATD: u8 = 16;
    pub(in super::super) const QUATF: u8 = 17;
    pub(in super::super) const VEC2F: u8 = 20;
    pub(in super::super) const VEC3D: u8 = 23;
    pub(in super::super) const VEC3F: u8 = 24;
    pub(in super::super) const TOKEN_LIST_OP: u8 = 32;
    pub(in super::super) const STRING_LIST_OP: u8 = 33;
    pub(in super::super) const TOKEN_VECTOR: u8 = 41;
    pub(in super::super) const SPECIFIER: u8 = 42;
    pub(in super::super) const TIME_SAMPLES: u8 = 46;
    pub(in super::super) const DOUBLE_VECTOR: u8 = 48;
    pub(in super::super) const STRING_VECTOR: u8 = 50;
    pub(in super::super) const VALUE_BLOCK: u8 = 51;
    pub(in super::super) const PAYLOAD: u8 = 47;
}

impl Rep {
    pub(super) fn kind(self) -> u8 {
        (self.0 >> 48).to_le_bytes()[0]
    }

    pub(super) fn is_array(self) -> bool {
        self.0 >> 63 & 1 == 1
    }

    pub(super) fn is_inlined(self) -> bool {
        self.0 >> 62 & 1 == 1
    }

    pub(super) fn is_compressed(self) -> bool {
        self.0 >> 61 & 1 == 1
    }

    pub(super) fn payload(self) -> u64 {
        self.0 & ((1 << 48) - 1)
    }

    pub(super) fn inline(self) -> [u8; 4] {
        let [a, b, c, d, ..] = self.0.to_le_bytes();
        [a, b, c, d]
    }
}
