//! One frame of a session that is watched, with its arrays for numpy.

use std::{any::Any, mem::offset_of, sync::Arc};

use pyo3::{prelude::*, types::PyDict};
use untangled_client::{
    PathPoint, PathRecord,
    observe::{InsideEntry, Observation},
};

use crate::{correction::header_by_name, memory::Memory};

/// One frame. It owns its memory, which never moves.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeObservation(Arc<Observation>);

impl NativeObservation {
    pub(crate) fn new(observation: Observation) -> Self {
        Self(Arc::new(observation))
    }

    fn view<T>(&self, start: *const T, layout: [usize; 3], type_string: &'static str) -> Memory {
        let owner: Arc<dyn Any + Send + Sync> = Arc::clone(&self.0) as _;
        Memory::new(start, layout, type_string, false, owner)
    }
}

#[pymethods]
impl NativeObservation {
    /// The positions, `num_vertices x 3` of f32; empty where they can't be used.
    fn positions(&self) -> Memory {
        self.view(self.0.positions.as_ptr(), [self.0.positions.len(), 3, 12], "<f4")
    }

    /// The values of all vertices, `num_vertices x 3` of f32.
    fn corrections(&self) -> Memory {
        self.view(self.0.corrections.as_ptr(), [self.0.corrections.len(), 3, 12], "<f4")
    }

    /// The flags, `num_vertices` of u32.
    fn flags(&self) -> Memory {
        self.view(self.0.flags.as_ptr(), [self.0.flags.len(), 0, 4], "<u4")
    }

    /// The vertices inside, each with its pair of paths, `num_inside x 2` of u32.
    fn inside(&self) -> Memory {
        self.view(self.0.inside.as_ptr(), [self.0.inside.len(), 2, size_of::<InsideEntry>()], "<u4")
    }

    /// The depth of each pair of paths, `num_pairs` of f32.
    fn depths(&self) -> Memory {
        self.view(self.0.depths_m.as_ptr(), [self.0.depths_m.len(), 0, 4], "<f4")
    }

    /// `num_paths x 8` numbers of the records, the points' positions (`x 3` of f64) and faces (`x 2` of u32).
    fn paths(&self) -> (Memory, Memory, Memory) {
        let paths = self.0.paths();
        let (records, points) = (paths.records, paths.points);
        let faces = points.as_ptr().cast::<u8>().wrapping_add(offset_of!(PathPoint, faces));
        (
            self.view(records.as_ptr(), [records.len(), 8, size_of::<PathRecord>()], "<u4"),
            self.view(points.as_ptr(), [points.len(), 3, size_of::<PathPoint>()], "<f8"),
            self.view(faces, [points.len(), 2, size_of::<PathPoint>()], "<u4"),
        )
    }

    /// The header of the correction by name, and what was observed beside it.
    fn header<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = header_by_name(py, self.0.header())?;
        dict.set_item("num_frames", self.0.num_frames())?;
        dict.set_item("num_dropped", self.0.num_dropped)?;
        dict.set_item("sent_s", self.0.sent().as_secs_f64())?;
        dict.set_item("refused", self.0.refusal().map(|refusal| refusal.to_string()))?;
        Ok(dict)
    }
}
