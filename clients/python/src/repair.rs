//! A repair, as views into shared memory.

use std::{
    any::Any,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use pyo3::{prelude::*, types::PyDict};
use untangled_client::Repair;

use crate::memory::Memory;

/// The repair of one frame. The lock guards the handle; the memory that it refers to never moves.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeRepair(Arc<Mutex<Repair>>);

impl NativeRepair {
    pub(crate) fn new(repair: Repair) -> Self {
        Self(Arc::new(Mutex::new(repair)))
    }

    /// Held for the duration of a getter, which does not wait.
    fn lock(&self) -> MutexGuard<'_, Repair> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl NativeRepair {
    /// The displacements, `num_vertices x 3` of f32 or f64.
    fn displacements(&self) -> Memory {
        let owner: Arc<dyn Any + Send + Sync> = Arc::clone(&self.0) as _;
        let repair = self.lock();
        match (repair.displacements_f32(), repair.displacements_f64()) {
            (Some(steps), _) => Memory::new(steps.as_ptr(), [steps.len(), 3, 12], "<f4", false, owner),
            (None, steps) => {
                let steps = steps.unwrap_or(&[]);
                Memory::new(steps.as_ptr(), [steps.len(), 3, 24], "<f8", false, owner)
            }
        }
    }

    /// The header by name.
    fn header<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let repair = self.lock();
        let header = repair.header();
        let dict = PyDict::new(py);
        dict.set_item("frame", header.frame)?;
        dict.set_item("simulated_s", header.simulated_s)?;
        dict.set_item("certified", repair.is_certified())?;
        dict.set_item("truncated", repair.is_truncated())?;
        dict.set_item("num_moved", header.num_moved)?;
        dict.set_item("num_edge_face_intersections", header.num_edge_face_intersections)?;
        dict.set_item("num_crossings", header.num_crossings)?;
        dict.set_item("num_inside_body", header.num_inside_body)?;
        dict.set_item("num_behind", header.num_behind)?;
        dict.set_item("num_pairs", header.num_pairs)?;
        dict.set_item("contour_length_m", header.contour_length_m)?;
        dict.set_item("mean_displacement_m", header.mean_displacement_m)?;
        dict.set_item("max_displacement_m", header.max_displacement_m)?;
        dict.set_item("min_edge_ratio", header.min_edge_ratio)?;
        dict.set_item("max_edge_ratio", header.max_edge_ratio)?;
        dict.set_item("min_area_ratio", header.min_area_ratio)?;
        dict.set_item("num_iterations", header.num_iterations)?;
        dict.set_item("waited_ns", header.waited_ns)?;
        dict.set_item("repair_ns", header.repair_ns)?;
        dict.set_item("num_replaced", header.num_replaced)?;
        Ok(dict)
    }
}
