//! A correction: daemon to host, one for each state that the daemon looked at.

pub mod sparse;

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

pub use sparse::{VertexEntry, VertexLabel};

/// Flags of a vertex.
pub mod flags {
    /// Inside of at least one path: switch the host's self-collision off here.
    pub const INSIDE: u32 = 1;
    /// On, or near, a path: switch the host's self-collision off here too.
    pub const NEAR_PATH: u32 = 1 << 1;
    /// The correction was limited.
    pub const CLAMPED: u32 = 1 << 2;
    /// Pinned: never corrected.
    pub const PINNED: u32 = 1 << 3;
    /// Where the host's self-collision has to be off, or it defends the tangle.
    pub const MASK: u32 = INSIDE | NEAR_PATH;
}

/// Types of pairs of intersection paths: indices into [`CorrectionHeader::num_pairs`].
pub mod pair_type {
    /// Two closed paths.
    pub const CLOSED: usize = 0;
    /// One closed path that meets one loop vertex twice.
    pub const EIGHT: usize = 1;
    /// One closed path with two loop vertices.
    pub const LOOP_LOOP: usize = 2;
    /// Boundary, loop vertex, inside.
    pub const BOUNDARY_LOOP_INSIDE: usize = 3;
    /// Boundary, loop vertex, boundary.
    pub const BOUNDARY_LOOP_BOUNDARY: usize = 4;
    /// Two BLI whose free ends touch.
    pub const BOUNDARY_LOOP_LOOP_BOUNDARY: usize = 5;
    /// Two BLI that share their loop vertex.
    pub const CROSS: usize = 6;
    /// One copy ends twice on the boundary, the other never.
    pub const BB_II: usize = 7;
    /// One copy ends twice on the boundary, the other once.
    pub const BB_BI: usize = 8;
    /// Both copies end twice on the boundary.
    pub const BB_BB: usize = 9;
    /// Both copies end once on the boundary.
    pub const BI_BI: usize = 10;

    /// Their names, by index.
    pub const NAMES: [&str; 11] =
        ["CLOSED/CLOSED", "EIGHT", "LL", "BLI", "BLB", "BLLB", "CROSS", "BB/II", "BB/BI", "BB/BB", "BI/BI"];
}

/// Stages of a frame: indices into [`CorrectionHeader::stage_ns`].
pub mod stage {
    /// Checking and copying the positions.
    pub const INGEST: usize = 0;
    /// Edge-face intersections.
    pub const INTERSECT: usize = 1;
    /// Tracing and classification.
    pub const PATHS: usize = 2;
    /// Inside regions.
    pub const REGIONS: usize = 3;
    /// Correspondence and targets.
    pub const CORRESPOND: usize = 4;
    /// Forces and flags.
    pub const RESPOND: usize = 5;
    /// Writing the correction, up to where its header is written.
    pub const PUBLISH: usize = 6;
    /// All of them together.
    pub const TOTAL: usize = 7;

    /// Their names, by index.
    pub const NAMES: [&str; 8] =
        ["ingest", "intersect", "paths", "regions", "correspond", "respond", "publish", "total"];
}

/// Flag in [`CorrectionHeader::flags`]: a limit ended the work, of time or of intersections. With status 0 the
/// correction is the best so far; with another one nothing is known of the frame.
pub const TRUNCATED: u32 = 1;
/// [`CorrectionHeader::fault_index`] where no element is at fault.
pub const NO_FAULT: u64 = u64::MAX;

/// Header of a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.CorrectionHeader")]
pub struct CorrectionHeader {
    /// The frame that this answers.
    pub frame: u64,
    /// Simulated time of that frame in seconds.
    pub simulated_s: f64,
    /// Step of that frame in seconds.
    pub dt_s: f64,
    /// [`Status`](crate::Status): other than 0, all values and flags are zero and only the fault below means anything.
    pub status: u32,
    /// [`CorrectionKind`](crate::CorrectionKind) of the values.
    pub kind: u32,
    /// [`TRUNCATED`] or 0.
    pub flags: u32,
    /// Number of vertices.
    pub num_vertices: u32,
    /// The vertex at fault where the status says so, or [`NO_FAULT`].
    pub fault_index: u64,
    /// The value at fault, or the limit that ended the frame: pairs of faces, or microseconds.
    pub fault_value: f64,
    /// Number of edges that pierce a face.
    pub num_edge_face_intersections: u64,
    /// Number of intersecting face pairs.
    pub num_face_pairs: u64,
    /// Length of all paths in the world in metres, each pair once.
    pub contour_length_m: f64,
    /// Number of vertices with [`flags::INSIDE`].
    pub num_inside: u64,
    /// Longest displacement that the correction makes in one step of `dt_s`, in metres.
    pub max_displacement_m: f64,
    /// Force left over, in newtons: the sum over all vertices before limits and pins. Without masses every vertex
    /// weighs 1 kg.
    pub net_force_n: [f64; 3],
    /// Torque left over about the centre of the corrected vertices, in newton metres.
    pub net_torque_nm: [f64; 3],
    /// Number of path pairs by [`pair_type`].
    pub num_pairs: [u32; 16],
    /// Time of each [`stage`] in nanoseconds.
    pub stage_ns: [u64; 8],
    /// Frames of this session so far that were overtaken by a newer one before the daemon looked at them.
    pub num_skipped_frames: u64,
    /// With [`TRUNCATED`]: number of path pairs, the shortest ones, for which time did not suffice. They have flags
    /// near the path only.
    pub num_pairs_left_out: u64,
    /// With [`TRUNCATED`]: their length in the world in metres.
    pub length_left_out_m: f64,
    /// Number of [`VertexEntry`] in the payload of a sparse correction; 0 in a dense one.
    pub num_values: u32,
    /// Number of [`VertexLabel`] behind them; 0 where no labels were asked for.
    pub num_labels: u32,
    /// Zero.
    pub progress: [u64; 2],
}

/// Correction of one vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.VertexCorrection")]
pub struct VertexCorrection {
    /// In the unit of the kind asked for.
    pub value: [f32; 3],
    /// See [`flags`].
    pub flags: u32,
}
