//! Types of the C interface, in C layout.

use client::{Correction, CorrectionHeader, Repair, RepairHeader};

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

/// The correction of one frame. Addresses point into shared memory, and are valid until `untangled_release` or
/// `untangled_close`.
#[repr(C)]
#[derive(Debug)]
pub struct CorrectionView {
    /// The frame that it is for.
    pub frame: u64,
    /// Simulated time of that frame in seconds.
    pub simulated_s: f64,
    /// Step of that frame in seconds.
    pub dt_s: f64,
    /// Number of vertices.
    pub num_vertices: usize,
    /// Value and flags of each vertex.
    pub vertices: *const VertexCorrection,
    /// Number of intersection paths; 0 where they were not asked for.
    pub num_paths: usize,
    /// Intersection paths, or null.
    pub paths: *const Path,
    /// Number of points of all paths.
    pub num_path_points: usize,
    /// Points of all paths, or null.
    pub path_points: *const PathPoint,
    /// What the values are.
    pub kind: u32,
    /// 1 where time was up before all paths had been worked on, else 0.
    pub truncated: u32,
    /// Number of edges that pierce a face.
    pub num_edge_face_intersections: u64,
    /// Number of intersecting face pairs.
    pub num_face_pairs: u64,
    /// Length of all paths in metres, each pair once.
    pub contour_length_m: f64,
    /// Number of vertices that are inside.
    pub num_inside: u64,
    /// Longest displacement that the correction makes in one step, in metres.
    pub max_displacement_m: f64,
    /// Force left over, in newtons.
    pub net_force_n: [f64; 3],
    /// Torque left over, in newton metres.
    pub net_torque_nm: [f64; 3],
    /// Number of path pairs by type, as in `untangled_path.pair_type`.
    pub num_pairs: [u32; 16],
    /// Nanoseconds of each stage: ingest, intersect, paths, regions, correspond, respond, publish, total.
    pub stage_ns: [u64; 8],
    /// Frames so far that were overtaken before the daemon looked at them.
    pub num_skipped_frames: u64,
    /// Where truncated: number of path pairs for which time did not suffice.
    pub num_pairs_left_out: u64,
    /// Where truncated: their length in metres.
    pub length_left_out_m: f64,
    /// What `untangled_release` knows it by.
    pub token: u64,
}

/// The repair of one frame: the displacement of every vertex to a state without intersections, or to the best that was
/// reached. Positions of the frame plus displacements, added in the precision of the session, are the bits that were
/// checked. Addresses point into shared memory, and are valid until `untangled_release_repair` or `untangled_close`.
#[repr(C)]
#[derive(Debug)]
pub struct RepairView {
    /// The frame whose positions the displacements are added to.
    pub frame: u64,
    /// Simulated time of that frame in seconds.
    pub simulated_s: f64,
    /// Number of vertices.
    pub num_vertices: usize,
    /// Displacements in metres, `num_vertices x 3`, of a session in single precision; else null.
    pub displacements: *const f32,
    /// Displacements in metres, `num_vertices x 3`, of a session in double precision; else null.
    pub displacements_f64: *const f64,
    /// 1 where an exact check found no crossing in the repaired state, else 0.
    pub certified: u32,
    /// 1 where time was up, else 0.
    pub truncated: u32,
    /// Number of vertices that move.
    pub num_moved: u32,
    /// Zero.
    pub reserved: u32,
    /// Edges that pierce a face in the repaired state.
    pub num_edge_face_intersections: u64,
    /// Pairs of faces that cross in the repaired state, as the check counts them.
    pub num_crossings: u64,
    /// Pairs of intersection paths in the repaired state.
    pub num_pairs: u64,
    /// Their length in metres.
    pub contour_length_m: f64,
    /// Mean displacement of the vertices that move, in metres.
    pub mean_displacement_m: f64,
    /// Largest displacement in metres.
    pub max_displacement_m: f64,
    /// Least length of an edge, divided by its length in the frame.
    pub min_edge_ratio: f64,
    /// Largest length of an edge, divided by its length in the frame.
    pub max_edge_ratio: f64,
    /// Least area of a face, divided by its area in the frame.
    pub min_area_ratio: f64,
    /// Number of iterations.
    pub num_iterations: u64,
    /// Nanoseconds that the request waited.
    pub waited_ns: u64,
    /// Nanoseconds of work.
    pub repair_ns: u64,
    /// Requests so far that a newer one replaced while they waited.
    pub num_replaced: u64,
    /// What `untangled_release_repair` knows it by.
    pub token: u64,
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

impl CorrectionView {
    /// The view of a correction that is kept for the caller.
    pub(crate) fn new(correction: &Correction, token: u64) -> Self {
        let header: &CorrectionHeader = correction.header();
        let vertices = correction.vertices();
        let paths = correction.paths();
        Self {
            frame: header.frame,
            simulated_s: header.simulated_s,
            dt_s: header.dt_s,
            num_vertices: vertices.len(),
            vertices: vertices.as_ptr().cast(),
            num_paths: paths.map_or(0, |paths| paths.records.len()),
            paths: paths.map_or(std::ptr::null(), |paths| paths.records.as_ptr().cast()),
            num_path_points: paths.map_or(0, |paths| paths.points.len()),
            path_points: paths.map_or(std::ptr::null(), |paths| paths.points.as_ptr().cast()),
            kind: header.kind,
            truncated: header.flags & 1,
            num_edge_face_intersections: header.num_edge_face_intersections,
            num_face_pairs: header.num_face_pairs,
            contour_length_m: header.contour_length_m,
            num_inside: header.num_inside,
            max_displacement_m: header.max_displacement_m,
            net_force_n: header.net_force_n,
            net_torque_nm: header.net_torque_nm,
            num_pairs: header.num_pairs,
            stage_ns: header.stage_ns,
            num_skipped_frames: header.num_skipped_frames,
            num_pairs_left_out: header.num_pairs_left_out,
            length_left_out_m: header.length_left_out_m,
            token,
        }
    }
}

impl RepairView {
    /// The view of a repair that is kept for the caller.
    pub(crate) fn new(repair: &Repair, token: u64) -> Self {
        let header: &RepairHeader = repair.header();
        let (single, double) = (repair.displacements_f32(), repair.displacements_f64());
        Self {
            frame: header.frame,
            simulated_s: header.simulated_s,
            num_vertices: single.map(<[_]>::len).or(double.map(<[_]>::len)).unwrap_or(0),
            displacements: single.map_or(std::ptr::null(), |steps| steps.as_ptr().cast()),
            displacements_f64: double.map_or(std::ptr::null(), |steps| steps.as_ptr().cast()),
            certified: u32::from(repair.is_certified()),
            truncated: u32::from(repair.is_truncated()),
            num_moved: header.num_moved,
            reserved: 0,
            num_edge_face_intersections: header.num_edge_face_intersections,
            num_crossings: header.num_crossings,
            num_pairs: header.num_pairs,
            contour_length_m: header.contour_length_m,
            mean_displacement_m: header.mean_displacement_m,
            max_displacement_m: header.max_displacement_m,
            min_edge_ratio: header.min_edge_ratio,
            max_edge_ratio: header.max_edge_ratio,
            min_area_ratio: header.min_area_ratio,
            num_iterations: header.num_iterations,
            waited_ns: header.waited_ns,
            repair_ns: header.repair_ns,
            num_replaced: header.num_replaced,
            token,
        }
    }
}
