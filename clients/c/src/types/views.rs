//! Corrections and repairs as C sees them.

use client::{Correction, CorrectionHeader, Repair, RepairHeader};

use super::{Path, PathPoint, VertexCorrection};

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
    /// 1 where an exact check found no crossing in the repaired state, and no cloth inside of a body or behind an inner
    /// layer; else 0.
    pub certified: u32,
    /// 1 where time was up, else 0.
    pub truncated: u32,
    /// Number of vertices that move.
    pub num_moved: u32,
    /// Vertices of cloth inside of a body in the repaired state; 0 without bodies.
    pub num_inside_body: u32,
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
    /// Vertices of cloth behind an inner layer in the repaired state; 0 without layers.
    pub num_behind: u64,
}

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
            num_inside_body: u32::try_from(header.num_inside_body).unwrap_or(u32::MAX),
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
            num_behind: header.num_behind,
        }
    }
}
