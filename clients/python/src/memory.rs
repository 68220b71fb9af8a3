//! Shared memory as a numpy array, by the array interface.

use std::{any::Any, sync::Arc};

use pyo3::{prelude::*, types::PyDict};

/// An array in memory of another owner, which this keeps mapped: `numpy.asarray` makes a view of it without a copy, and
/// keeps a reference to this object for as long as the view lives.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct Memory {
    address: usize,
    shape: Vec<usize>,
    strides: Vec<usize>,
    type_string: &'static str,
    writable: bool,
    _owner: Arc<dyn Any + Send + Sync>,
}

impl Memory {
    /// `num` elements of `width` numbers (a plain list for 0), `stride` bytes apart.
    pub(crate) fn new<T>(
        start: *const T,
        [num, width, stride]: [usize; 3],
        type_string: &'static str,
        writable: bool,
        owner: Arc<dyn Any + Send + Sync>,
    ) -> Self {
        let number = usize::from(type_string.as_bytes()[2] - b'0');
        let (shape, strides) = match width {
            0 => (vec![num], vec![stride]),
            width => (vec![num, width], vec![stride, number]),
        };
        Self { address: start.addr(), shape, strides, type_string, writable, _owner: owner }
    }
}

#[pymethods]
impl Memory {
    /// Version 3 of numpy's array interface.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("data", (self.address, !self.writable))?;
        interface.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        interface.set_item("strides", pyo3::types::PyTuple::new(py, &self.strides)?)?;
        interface.set_item("typestr", self.type_string)?;
        Ok(interface)
    }
}
