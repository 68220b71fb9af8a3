//! Types of the C interface, in C layout.

mod views;

use client::Correction;
pub use views::*;

/// A connection to a daemon; `{0}` is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClientHandle {
    /// Its number.
    pub id: u64,
}

/// One cloth that the daemon knows; `{0}` is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SessionHandle {
    /// Its number.
    pub id: u64,
}

/// A filter of contacts; `{0}` is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactsHandle {
    /// Its number.
    pub id: u64,
}

/// Precision of the positions that a session publishes.
#[repr(u32)]
#[derive(Clone, Copy, Debug)]
pub enum PositionPrecision {
    /// Single.
    F32 = 0,
    /// Double.
    F64 = 1,
}

/// What corrections shall be.
#[repr(u32)]
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Newtons; needs masses.
    Force = 0,
    /// Metres per second squared.
    Acceleration = 1,
    /// Metres per second.
    VelocityChange = 2,
    /// Metres.
    Displacement = 3,
}

/// The vertex is inside: switch the host's self-collision off here.
pub const UNTANGLED_INSIDE: u32 = 1;
/// The vertex is near a path: switch the host's self-collision off here too.
pub const UNTANGLED_NEAR_PATH: u32 = 2;
/// The correction was limited.
pub const UNTANGLED_CLAMPED: u32 = 4;
/// The vertex is pinned and never corrected.
pub const UNTANGLED_PINNED: u32 = 8;
/// Where the host's self-collision has to be off, or it defends the tangle: inside or near a path.
pub const UNTANGLED_MASK: u32 = 3;

/// Option of a registration: corrections list only the vertices that have a value or a flag, see `untangled_entries`.
/// `vertices` of a correction holds all of them even so, at the cost of these entries. A daemon that is too old sends
/// all vertices.
pub const UNTANGLED_SPARSE: u32 = 1;
/// Option of a registration: corrections have labels, which say of single contacts whether they have to be off, see
/// `untangled_contacts_set`. Makes them sparse as well. A daemon that is too old sends none.
pub const UNTANGLED_LABELS: u32 = 2;
/// Option of a registration: frames may be repaired, see `untangled_exchange_repair`. Takes shared memory for four
/// frames more.
pub const UNTANGLED_REPAIRS: u32 = 4;
/// Option of a registration: vertices with exactly one place in `rest_positions_m` are one along seams, for meshes that
/// were split for texture coordinates or normals; see `untangled_num_welded_vertices`. They have to be in one place in
/// each state, and corrections keep them there. A daemon that is too old refuses it.
pub const UNTANGLED_WELD: u32 = 8;

/// Value and flags of a vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VertexCorrection {
    /// In the unit of the kind that was asked for.
    pub value: [f32; 3],
    /// `UNTANGLED_INSIDE` and so on.
    pub flags: u32,
}

/// Value and flags of a vertex, with its index.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The vertex.
    pub vertex: u32,
    /// In the unit of the kind that was asked for.
    pub value: [f32; 3],
    /// `UNTANGLED_INSIDE` and so on.
    pub flags: u32,
}

/// A vertex and its side of a pair of paths.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Label {
    /// The vertex.
    pub vertex: u32,
    /// `4 * pair + side`, side 1 or 2, 3 for both; `0xffffffff` for both sides of every pair.
    pub label: u32,
}

/// What a sparse correction lists. Addresses are valid as long as those of the correction.
#[repr(C)]
#[derive(Debug)]
pub struct SparseView {
    /// Whether the correction came sparse.
    pub is_sparse: bool,
    /// Number of entries.
    pub num_entries: usize,
    /// The vertices that have a value or a flag other than pinned, ascending.
    pub entries: *const Entry,
    /// Number of labels; 0 where they were not asked for.
    pub num_labels: usize,
    /// Labels, ascending by vertex.
    pub labels: *const Label,
}

impl Default for SparseView {
    fn default() -> Self {
        let (entries, labels) = (std::ptr::null(), std::ptr::null());
        Self { is_sparse: false, num_entries: 0, entries, num_labels: 0, labels }
    }
}

impl SparseView {
    /// What a correction that is kept for the caller lists.
    pub(crate) fn new(correction: &Correction) -> Self {
        let Some(entries) = correction.sparse() else { return Self::default() };
        let labels = correction.labels();
        Self {
            is_sparse: true,
            num_entries: entries.len(),
            entries: entries.as_ptr().cast(),
            num_labels: labels.len(),
            labels: labels.as_ptr().cast(),
        }
    }
}

/// An intersection path.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Which pair it belongs to.
    pub pair: u32,
    /// Type of that pair: CLOSED/CLOSED, EIGHT, LL, BLI, BLB, BLLB, CROSS, BB/II, BB/BI, BB/BB, BI/BI.
    pub pair_type: u32,
    /// Type of this path: CLOSED, LL, BLI, BLB, BB, BI, II.
    pub path_type: u32,
    /// Index of the corresponding path; its own where it is its own.
    pub partner: u32,
    /// 1 for a loop on the cloth, else 0.
    pub closed: u32,
    /// Index of its first point. Check it against the number of points: the daemon wrote it.
    pub first_point: u32,
    /// Number of its points.
    pub num_points: u32,
    /// Zero.
    pub reserved: u32,
}

/// A point of an intersection path.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PathPoint {
    /// In the world, in metres.
    pub position_m: [f64; 3],
    /// The face that the path runs through after this point, and the partner's.
    pub faces: [u32; 2],
}

const _: () = {
    assert!(size_of::<VertexCorrection>() == size_of::<client::VertexCorrection>());
    assert!(align_of::<VertexCorrection>() == align_of::<client::VertexCorrection>());
    assert!(std::mem::offset_of!(VertexCorrection, flags) == std::mem::offset_of!(client::VertexCorrection, flags));
    assert!(size_of::<Entry>() == size_of::<client::VertexEntry>() && align_of::<Entry>() == 4);
    assert!(std::mem::offset_of!(Entry, flags) == std::mem::offset_of!(client::VertexEntry, flags));
    assert!(size_of::<Label>() == size_of::<client::VertexLabel>() && align_of::<Label>() == 4);
    assert!(std::mem::offset_of!(Label, label) == std::mem::offset_of!(client::VertexLabel, label));
    assert!(size_of::<Path>() == size_of::<client::PathRecord>() && align_of::<Path>() == 4);
    assert!(std::mem::offset_of!(Path, num_points) == std::mem::offset_of!(client::PathRecord, num_points));
    assert!(size_of::<PathPoint>() == size_of::<client::PathPoint>() && align_of::<PathPoint>() == 8);
    assert!(std::mem::offset_of!(PathPoint, faces) == std::mem::offset_of!(client::PathPoint, faces));
    assert!(UNTANGLED_INSIDE == client::flags::INSIDE && UNTANGLED_NEAR_PATH == client::flags::NEAR_PATH);
    assert!(UNTANGLED_CLAMPED == client::flags::CLAMPED && UNTANGLED_PINNED == client::flags::PINNED);
    assert!(UNTANGLED_MASK == client::flags::MASK);
};
