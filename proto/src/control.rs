//! Requests and replies. These structs keep their names and layout in every version of the protocol.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;
use serde::{Deserialize, Serialize};

/// What a client asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum RequestKind {
    /// Who are you? The reply is a JSON document: see [`Hello`].
    Hello = 1,
    /// Open a session: [`RegisterParams`] and the sections of a mesh.
    Register = 2,
    /// Change the settings of a session: a settings section.
    UpdateSettings = 3,
    /// End a session.
    Close = 4,
    /// How is it going? The reply is a JSON document, schema `untangled.status/1`.
    Status = 5,
    /// Watch a session. The reply's payload is a part of its mesh, see [`ReplyHeader::num_bytes`]. The session's views
    /// are published from then on while somebody subscribes.
    Observe = 6,
}

impl RequestKind {
    /// The kind of a value on the wire, if it is one.
    #[must_use]
    pub fn from_code(code: u32) -> Option<Self> {
        [Self::Hello, Self::Register, Self::UpdateSettings, Self::Close, Self::Status, Self::Observe]
            .into_iter()
            .find(|kind| *kind as u32 == code)
    }
}

/// Header of a request. The payload is a section table and its bytes: see [`sections`](crate::sections).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.control.RequestHeader")]
pub struct RequestHeader {
    /// The client's [`PROTOCOL_VERSION`](crate::PROTOCOL_VERSION).
    pub protocol_version: u32,
    /// [`RequestKind`].
    pub kind: u32,
    /// The session that is meant, for update, close and observe.
    pub session: u64,
    /// Entries of the section table.
    pub num_sections: u32,
    /// Zero.
    pub flags: u32,
    /// Tells this request from all others; the reply repeats it. iceoryx2 0.10 can hand a late reply to a client that
    /// took the place of the one that it was meant for.
    pub token: [u64; 2],
    /// Zero.
    pub reserved: [u64; 3],
}

/// Header of a reply. The payload is UTF-8, a JSON document or the reason for a refusal in words; only that of a mesh
/// ([`RequestKind::Observe`]) is bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.control.ReplyHeader")]
pub struct ReplyHeader {
    /// The daemon's [`PROTOCOL_VERSION`](crate::PROTOCOL_VERSION).
    pub protocol_version: u32,
    /// [`Status`](crate::Status).
    pub status: u32,
    /// Tells one run of the daemon from the next; part of the names of a session's services.
    pub instance: u64,
    /// The session that was registered.
    pub session: u64,
    /// That of the request.
    pub token: [u64; 2],
    /// Vertices of the session that was registered that belong to bodies. A daemon that does not know bodies writes
    /// zero, from which a client sees that it took them for cloth.
    pub num_body_vertices: u64,
    /// Vertices of the session that was registered with [`SessionOptions::WELD`], those in one place counted once. Zero
    /// without that option, and from a daemon that does not know it.
    pub num_places: u64,
    /// Bytes of the whole mesh of which the payload of the reply to [`RequestKind::Observe`] is a part; else zero.
    pub num_bytes: u64,
}

/// The feature of a [`Hello`] that says that the daemon knows the section
/// [`id::BODY`](crate::sections::id::BODY).
pub const BODY: &str = "body";
/// The feature of a [`Hello`] that says that the daemon knows [`RequestKind::Observe`].
pub const OBSERVE: &str = "observe";

/// What a daemon says of itself, as JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Its protocol version.
    pub protocol_version: u32,
    /// Its library version.
    pub library_version: String,
    /// Its iceoryx2 version.
    pub iceoryx2_version: String,
    /// Its process.
    pub pid: u32,
    /// Names of the [`SessionOptions`] that it knows, [`BODY`] and [`OBSERVE`]; none from a daemon that is older than
    /// they.
    #[serde(default)]
    pub features: Vec<String>,
}

/// The part of a registration that has a fixed size: section [`id::PARAMS`](crate::sections::id::PARAMS),
/// little-endian, 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct RegisterParams {
    /// Number of vertices.
    pub num_vertices: u64,
    /// [`Precision`] of positions.
    pub precision: u32,
    /// [`CorrectionKind`] that is asked for.
    pub correction: u32,
    /// Zero.
    pub reserved: [u64; 2],
}

impl RegisterParams {
    /// The bytes on the wire.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 32] {
        let mut bytes = [0; 32];
        bytes[0..8].copy_from_slice(&self.num_vertices.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.precision.to_le_bytes());
        bytes[12..16].copy_from_slice(&self.correction.to_le_bytes());
        bytes
    }

    /// From the bytes on the wire; nothing if there are not 32 of them.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; 32] = bytes.try_into().ok()?;
        let word = |at: usize| std::array::from_fn(|k| bytes[at + k]);
        Some(Self {
            num_vertices: u64::from_le_bytes(std::array::from_fn(|k| bytes[k])),
            precision: u32::from_le_bytes(word(8)),
            correction: u32::from_le_bytes(word(12)),
            reserved: [0; 2],
        })
    }
}

/// What a session asks for beyond what protocol 1 began with: section
/// [`id::OPTIONS`](crate::sections::id::OPTIONS). A daemon refuses bits that it does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SessionOptions(u32);

impl SessionOptions {
    /// Corrections list only the vertices that have a value or a flag other than pinned.
    pub const SPARSE: Self = Self(1);
    /// Sparse corrections with labels: see [`VertexLabel`](crate::VertexLabel).
    pub const LABELS: Self = Self(2);
    /// A service for repairs: see [`RepairHeader`](crate::RepairHeader).
    pub const REPAIR: Self = Self(4);
    /// Vertices with exactly one place at rest are one along seams: see [`ReplyHeader::num_places`].
    pub const WELD: Self = Self(8);
    /// Each option with its name among the features of a [`Hello`].
    pub const NAMES: [(&str, Self); 4] =
        [("sparse", Self::SPARSE), ("labels", Self::LABELS), ("repair", Self::REPAIR), ("weld", Self::WELD)];

    /// The options of a value on the wire; nothing where it has bits that are not known.
    #[must_use]
    pub fn from_bits(bits: u32) -> Option<Self> {
        let known = Self::NAMES.iter().fold(0, |bits, (_, option)| bits | option.0);
        (bits & !known == 0).then_some(Self(bits))
    }

    /// The value on the wire.
    #[must_use]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// These options and those of `other`.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether all options of `other` are among these.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether corrections are sparse. Labels come with sparse corrections only.
    #[must_use]
    pub fn is_sparse(self) -> bool {
        self.contains(Self::SPARSE) || self.has_labels()
    }

    /// Whether corrections have labels.
    #[must_use]
    pub fn has_labels(self) -> bool {
        self.contains(Self::LABELS)
    }

    /// Whether frames may be repaired.
    #[must_use]
    pub fn has_repairs(self) -> bool {
        self.contains(Self::REPAIR)
    }

    /// Whether vertices in one place are one.
    #[must_use]
    pub fn is_welded(self) -> bool {
        self.contains(Self::WELD)
    }
}

/// Precision of the positions of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u32)]
pub enum Precision {
    /// [`PositionF32`](crate::PositionF32).
    #[default]
    F32 = 0,
    /// [`PositionF64`](crate::PositionF64).
    F64 = 1,
}

impl Precision {
    /// The precision of a value on the wire, if it is one.
    #[must_use]
    pub fn from_code(code: u32) -> Option<Self> {
        [Self::F32, Self::F64].into_iter().find(|precision| *precision as u32 == code)
    }
}

/// What the values of a correction are. With `f` the force of the method in kg m/step^2, `m` the vertex's mass (1 kg
/// where none was registered) and `dt` the step of the frame:
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[repr(u32)]
pub enum CorrectionKind {
    /// Newtons: `f / dt^2`. Needs masses.
    Force = 0,
    /// m/s^2: `f / (m dt^2)`.
    Acceleration = 1,
    /// m/s: `f / (m dt)`.
    VelocityChange = 2,
    /// Metres: `f / m`.
    #[default]
    Displacement = 3,
}

impl CorrectionKind {
    /// The kind of a value on the wire, if it is one.
    #[must_use]
    pub fn from_code(code: u32) -> Option<Self> {
        [Self::Force, Self::Acceleration, Self::VelocityChange, Self::Displacement]
            .into_iter()
            .find(|kind| *kind as u32 == code)
    }
}
