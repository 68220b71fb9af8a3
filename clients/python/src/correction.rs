//! A correction with its arrays for numpy.

use std::{
    any::Any,
    mem::offset_of,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use pyo3::{prelude::*, types::PyDict};
use untangled_client::{Correction, PathPoint, PathRecord, VertexCorrection, VertexEntry, VertexLabel, pair_type};
use untangled_proto::{
    CorrectionHeader,
    correction::{REPAIRING, TRUNCATED, stage},
};

use crate::memory::Memory;

/// The correction of one frame. The lock guards the handle; the memory that it refers to never moves.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeCorrection(Arc<Mutex<Correction>>);

impl NativeCorrection {
    pub(crate) fn new(correction: Correction) -> Self {
        Self(Arc::new(Mutex::new(correction)))
    }

    /// Held for the duration of a getter, which does not wait.
    fn lock(&self) -> MutexGuard<'_, Correction> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn view<T>(&self, start: *const T, layout: [usize; 3], type_string: &'static str) -> Memory {
        let owner: Arc<dyn Any + Send + Sync> = Arc::clone(&self.0) as _;
        Memory::new(start, layout, type_string, false, owner)
    }
}

#[pymethods]
impl NativeCorrection {
    /// The values, `num_vertices x 3` of f32.
    fn values(&self) -> Memory {
        let correction = self.lock();
        let vertices = correction.vertices();
        self.view(vertices.as_ptr(), [vertices.len(), 3, size_of::<VertexCorrection>()], "<f4")
    }

    /// The flags, `num_vertices` of u32.
    fn flags(&self) -> Memory {
        let correction = self.lock();
        let vertices = correction.vertices();
        let offset = offset_of!(VertexCorrection, flags);
        let start = vertices.as_ptr().cast::<u8>().wrapping_add(offset);
        self.view(start, [vertices.len(), 0, size_of::<VertexCorrection>()], "<u4")
    }

    /// Of a sparse correction the vertices of its entries (`num_entries` of u32), their values (`x 3` of f32) and flags
    /// (of u32); nothing of a dense one.
    fn entries(&self) -> Option<(Memory, Memory, Memory)> {
        let correction = self.lock();
        let entries = correction.sparse()?;
        let at = |offset: usize| entries.as_ptr().cast::<u8>().wrapping_add(offset);
        let (num, stride) = (entries.len(), size_of::<VertexEntry>());
        Some((
            self.view(at(offset_of!(VertexEntry, vertex)), [num, 0, stride], "<u4"),
            self.view(at(offset_of!(VertexEntry, value)), [num, 3, stride], "<f4"),
            self.view(at(offset_of!(VertexEntry, flags)), [num, 0, stride], "<u4"),
        ))
    }

    /// The labels, `num_labels x 2` of u32: vertex and label.
    fn labels(&self) -> Memory {
        let correction = self.lock();
        let labels = correction.labels();
        self.view(labels.as_ptr(), [labels.len(), 2, size_of::<VertexLabel>()], "<u4")
    }

    /// Nothing, or `num_paths x 8` numbers of the records, the points' positions (`x 3` of f64) and faces (`x 2` of
    /// u32).
    fn paths(&self) -> Option<(Memory, Memory, Memory)> {
        let correction = self.lock();
        let paths = correction.paths()?;
        let (records, points) = (paths.records, paths.points);
        let offset = offset_of!(PathPoint, faces);
        let faces = points.as_ptr().cast::<u8>().wrapping_add(offset);
        Some((
            self.view(records.as_ptr(), [records.len(), 8, size_of::<PathRecord>()], "<u4"),
            self.view(points.as_ptr(), [points.len(), 3, size_of::<PathPoint>()], "<f8"),
            self.view(faces, [points.len(), 2, size_of::<PathPoint>()], "<u4"),
        ))
    }

    /// The header by name.
    fn header<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let header = *self.lock().header();
        header_by_name(py, &header)
    }
}

/// The header of a correction by name.
pub(crate) fn header_by_name<'py>(py: Python<'py>, header: &CorrectionHeader) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("frame", header.frame)?;
    dict.set_item("simulated_s", header.simulated_s)?;
    dict.set_item("dt_s", header.dt_s)?;
    dict.set_item("kind", header.kind)?;
    dict.set_item("truncated", header.flags & TRUNCATED != 0)?;
    dict.set_item("being_repaired", header.flags & REPAIRING != 0)?;
    dict.set_item("num_edge_face_intersections", header.num_edge_face_intersections)?;
    dict.set_item("num_face_pairs", header.num_face_pairs)?;
    dict.set_item("contour_length_m", header.contour_length_m)?;
    dict.set_item("num_inside", header.num_inside)?;
    dict.set_item("max_displacement_m", header.max_displacement_m)?;
    dict.set_item("net_force_n", header.net_force_n)?;
    dict.set_item("net_torque_nm", header.net_torque_nm)?;
    let num_pairs = PyDict::new(py);
    for (name, count) in pair_type::NAMES.iter().zip(header.num_pairs).filter(|(_, count)| *count > 0) {
        num_pairs.set_item(*name, count)?;
    }
    dict.set_item("num_pairs", num_pairs)?;
    let stages = PyDict::new(py);
    for (name, nanoseconds) in stage::NAMES.iter().zip(header.stage_ns) {
        stages.set_item(*name, nanoseconds)?;
    }
    dict.set_item("stage_ns", stages)?;
    dict.set_item("num_skipped_frames", header.num_skipped_frames)?;
    dict.set_item("num_pairs_left_out", header.num_pairs_left_out)?;
    dict.set_item("length_left_out_m", header.length_left_out_m)?;
    Ok(dict)
}
