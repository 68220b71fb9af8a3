//! The native half of the Python package `untangled_cloth`: what its `session.py` and `library.py` are made of.
//!
//! Arrays cross the border in two ways. Positions of a frame, corrections and paths are shared memory, which numpy
//! views through `__array_interface__`: an address, a shape, and an object that keeps the memory mapped for as long as
//! an array refers to it. Arrays that are passed once (a registration, a mesh to analyse) are bytes, copied.
//!
//! Sessions may be used from any thread, by one at a time, and release the interpreter's lock while they wait.

mod bytes;
mod contacts;
mod correction;
mod error;
mod library;
mod memory;
mod observe;
mod repair;
mod repaired;
mod session;

use pyo3::prelude::*;

/// The module `untangled_cloth._native`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<session::NativeSession>()?;
    module.add_class::<correction::NativeCorrection>()?;
    module.add_class::<repair::NativeRepair>()?;
    module.add_class::<contacts::NativeContactFilter>()?;
    module.add_class::<observe::NativeObserver>()?;
    module.add_class::<observe::NativeObservation>()?;
    module.add_class::<memory::Memory>()?;
    module.add_function(wrap_pyfunction!(library::analyse, module)?)?;
    module.add_function(wrap_pyfunction!(library::count_intersections, module)?)?;
    module.add_function(wrap_pyfunction!(library::fix, module)?)?;
    module.add_function(wrap_pyfunction!(session::status, module)?)?;
    module.add_function(wrap_pyfunction!(observe::sessions, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::add(module)
}
