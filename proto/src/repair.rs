//! A repair: daemon to host, beside the corrections, for each state that asked for one and was not overtaken.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

/// Flag in [`RepairHeader::flags`]: an exact check found no crossing at the bits that the host has after adding the
/// displacement in the precision of its session, and no vertex inside of a body or behind an inner layer.
pub const CERTIFIED: u32 = 1;
/// Flag in [`RepairHeader::flags`]: time was up; the displacement leads to the best state so far.
pub const TRUNCATED: u32 = 1 << 1;

/// Header of a repair. Its payload is the displacement of every vertex in metres, in the precision of the session.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.RepairHeader")]
pub struct RepairHeader {
    /// The frame whose positions the displacement is added to.
    pub frame: u64,
    /// Simulated time of that frame in seconds.
    pub simulated_s: f64,
    /// [`Status`](crate::Status): other than 0, all displacements are zero and only the fault below means anything.
    pub status: u32,
    /// [`CERTIFIED`], [`TRUNCATED`].
    pub flags: u32,
    /// Number of vertices.
    pub num_vertices: u32,
    /// Number of vertices with a displacement other than zero.
    pub num_moved: u32,
    /// The vertex at fault where the status says so, or [`NO_FAULT`](crate::correction::NO_FAULT).
    pub fault_index: u64,
    /// The value at fault, or the limit that ended the repair.
    pub fault_value: f64,
    /// Edges that pierce a face in the repaired state.
    pub num_edge_face_intersections: u64,
    /// Pairs of faces that cross in the repaired state, as the check counts them.
    pub num_crossings: u64,
    /// Intersection paths in the repaired state, as pairs.
    pub num_pairs: u64,
    /// Their length in the world in metres.
    pub contour_length_m: f64,
    /// Mean displacement of the vertices that moved, in metres.
    pub mean_displacement_m: f64,
    /// Largest displacement in metres.
    pub max_displacement_m: f64,
    /// Least length of an edge in the repaired state, divided by its length in the frame.
    pub min_edge_ratio: f64,
    /// Largest length of an edge in the repaired state, divided by its length in the frame.
    pub max_edge_ratio: f64,
    /// Least area of a face in the repaired state, divided by its area in the frame.
    pub min_area_ratio: f64,
    /// Number of iterations.
    pub num_iterations: u64,
    /// Time from the request to the begin of the work, in nanoseconds.
    pub waited_ns: u64,
    /// Time of the work in nanoseconds, up to where this header is written.
    pub repair_ns: u64,
    /// Requests of this session so far that a newer one replaced while they waited.
    pub num_replaced: u64,
    /// Vertices of cloth inside of a body in the repaired state, as the check counts them.
    pub num_inside_body: u64,
    /// Vertices of cloth behind an inner layer in the repaired state, as the check counts them.
    pub num_behind: u64,
    /// Zero.
    pub reserved: [u64; 3],
}
