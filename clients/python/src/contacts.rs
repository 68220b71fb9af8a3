//! Which contacts have to be off, for arrays of them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::{exceptions::PyValueError, prelude::*, types::PyBytes};
use untangled_client::ContactFilter;

/// A filter for the contacts of one cloth.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeContactFilter(Mutex<ContactFilter>);

impl NativeContactFilter {
    fn lock(&self) -> MutexGuard<'_, ContactFilter> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One byte for each contact, 1 where it is off; the ends are bytes of u32, `A` and `B` of them for each contact.
    fn answer<'py, const A: usize, const B: usize>(
        &self,
        py: Python<'py>,
        [first, second]: [&[u8]; 2],
        is_off: impl Fn(&ContactFilter, [u32; A], [u32; B]) -> bool + Sync,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let num_contacts = first.len() / (4 * A);
        if first.len() != 4 * A * num_contacts || second.len() != 4 * B * num_contacts {
            return Err(PyValueError::new_err("the two ends of the contacts differ in number"));
        }
        PyBytes::new_with(py, num_contacts, |off| {
            py.detach(|| {
                let filter = self.lock();
                let ends = first.chunks_exact(4 * A).zip(second.chunks_exact(4 * B));
                for (off, (first, second)) in off.iter_mut().zip(ends) {
                    *off = u8::from(is_off(&filter, words(first), words(second)));
                }
            });
            Ok(())
        })
    }
}

/// Numbers of u32 in the machine's order.
fn words<const N: usize>(bytes: &[u8]) -> [u32; N] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|k| u32::from_ne_bytes(words[k]))
}

#[pymethods]
impl NativeContactFilter {
    #[new]
    fn new(num_vertices: usize) -> Self {
        Self(Mutex::new(ContactFilter::new(num_vertices)))
    }

    /// Takes labels, vertex and label as bytes of u32, in place of those before.
    fn set(&self, py: Python<'_>, labels: &[u8]) {
        py.detach(|| {
            let labels = labels.chunks_exact(8).map(words::<2>);
            self.lock().set(labels.map(|[vertex, label]| (vertex, label)));
        });
    }

    /// Whether contacts of a vertex and a face are off, a byte each; indices as bytes of u32.
    fn vertex_faces_off<'py>(&self, py: Python<'py>, vertices: &[u8], faces: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        self.answer(py, [vertices, faces], |filter, [vertex], face| filter.vertex_face_is_off(vertex, face))
    }

    /// Whether contacts of two edges are off, a byte each; indices as bytes of u32.
    fn edge_edges_off<'py>(&self, py: Python<'py>, first: &[u8], second: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        self.answer(py, [first, second], ContactFilter::edge_edge_is_off)
    }
}
