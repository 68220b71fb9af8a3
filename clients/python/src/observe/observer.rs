//! An observer of a session.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use pyo3::{prelude::*, types::PyDict};
use untangled_client::{
    CorrectionKind, Precision,
    observe::{self, ObservedProcess, ObservedSession, Observer, ObserverOptions},
};

use super::observation::NativeObservation;
use crate::{
    bytes::of_u32s,
    error::{self, Error},
    session::{SLICE, seconds},
};

/// An observer, until it is closed.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeObserver(Mutex<Option<Observer>>);

#[pymethods]
impl NativeObserver {
    /// Begins to watch a session; without its id the only one.
    #[new]
    fn new(
        py: Python<'_>,
        session: Option<u64>,
        domain: Option<String>,
        timeout_s: f64,
        name: Option<String>,
    ) -> PyResult<Self> {
        let options = ObserverOptions { domain, timeout: seconds(timeout_s)?, name };
        let observer = py.detach(|| {
            let session = session.map_or_else(|| only_session(&options), Ok)?;
            Observer::open(options, session).map_err(error::observe)
        })?;
        Ok(Self(Mutex::new(Some(observer))))
    }

    /// The newest frame that was not seen yet; waits for one.
    fn latest(&self, py: Python<'_>, timeout_s: f64) -> PyResult<Option<NativeObservation>> {
        let begin = Instant::now();
        let timeout = seconds(timeout_s)?;
        loop {
            let left = timeout.saturating_sub(begin.elapsed());
            let wait = left.min(SLICE);
            let seen = py.detach(|| self.with(|observer| observer.latest(wait).map_err(error::observe)))?;
            if seen.is_some() || left <= SLICE {
                return Ok(seen.map(NativeObservation::new));
            }
            py.check_signals()?;
        }
    }

    /// Watches the session that takes the place of one that has ended.
    fn reopen(&self, py: Python<'_>, timeout_s: f64) -> PyResult<()> {
        let begin = Instant::now();
        let timeout = seconds(timeout_s)?;
        loop {
            let left = timeout.saturating_sub(begin.elapsed());
            // Long enough for a busy machine to answer within.
            let slice = left.min(Duration::from_secs(1));
            match py.detach(|| self.with(|observer| observer.reopen(slice).map_err(error::observe))) {
                Err(_) if begin.elapsed() < timeout => py.check_signals()?,
                other => return other,
            }
        }
    }

    /// The session, as it was when it was opened.
    fn session<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let session = py.detach(|| self.with(|observer| Ok(observer.session().clone())))?;
        by_name(py, &session)
    }

    /// The mesh: counts and names, and arrays as bytes of u32.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mesh = py.detach(|| self.with(|observer| Ok(observer.mesh().clone())))?;
        let dict = PyDict::new(py);
        dict.set_item("num_vertices", mesh.num_vertices)?;
        dict.set_item("triangles", of_u32s(mesh.triangles.into_flattened()))?;
        dict.set_item("body", of_u32s(mesh.body))?;
        dict.set_item("pins", of_u32s(mesh.pins))?;
        dict.set_item("layers", mesh.layers.map(of_u32s))?;
        let outwards = mesh.outwards.map(|outwards| outwards.into_iter().map(u8::from).collect::<Vec<u8>>());
        dict.set_item("outwards", outwards)?;
        dict.set_item("double", mesh.precision == Precision::F64)?;
        dict.set_item(
            "correction",
            match mesh.correction {
                CorrectionKind::Force => "force",
                CorrectionKind::Acceleration => "acceleration",
                CorrectionKind::VelocityChange => "velocity",
                CorrectionKind::Displacement => "displacement",
            },
        )?;
        Ok(dict)
    }

    /// Ends the watching.
    fn close(&self, py: Python<'_>) {
        py.detach(|| drop(self.lock().take()));
    }
}

impl NativeObserver {
    /// Must not be called while the interpreter's lock is held, since the holder of this lock may be waiting.
    fn lock(&self) -> MutexGuard<'_, Option<Observer>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<T>(&self, call: impl FnOnce(&mut Observer) -> PyResult<T>) -> PyResult<T> {
        call(self.lock().as_mut().ok_or_else(|| Error::new_err("the observer is closed"))?)
    }
}

fn only_session(options: &ObserverOptions) -> PyResult<u64> {
    match &observe::sessions(options).map_err(error::observe)?[..] {
        [session] => Ok(session.session),
        [] => Err(Error::new_err("there is no session")),
        several => {
            let ids: Vec<String> = several.iter().map(|session| session.session.to_string()).collect();
            Err(Error::new_err(format!("there are sessions {}: say which one", ids.join(", "))))
        }
    }
}

/// The sessions that a daemon serves now.
#[pyfunction]
pub(crate) fn sessions<'py>(
    py: Python<'py>,
    domain: Option<String>,
    timeout_s: f64,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let options = ObserverOptions { domain, timeout: seconds(timeout_s)?, name: None };
    let found = py.detach(|| observe::sessions(&options).map_err(error::observe))?;
    found.iter().map(|session| by_name(py, session)).collect()
}

fn by_name<'py>(py: Python<'py>, session: &ObservedSession) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("session", session.session)?;
    dict.set_item("instance", session.instance)?;
    dict.set_item("host", session.host.as_ref().map(|host| process(py, host)).transpose()?)?;
    dict.set_item("num_vertices", session.num_vertices)?;
    dict.set_item("num_faces", session.num_faces)?;
    dict.set_item("num_frames", session.num_frames)?;
    dict.set_item("rate_hz", session.rate_hz)?;
    let observers: PyResult<Vec<_>> = session.observers.iter().map(|observer| process(py, observer)).collect();
    dict.set_item("observers", observers?)?;
    Ok(dict)
}

fn process<'py>(py: Python<'py>, ObservedProcess { pid, name }: &ObservedProcess) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("pid", *pid)?;
    dict.set_item("name", name)?;
    Ok(dict)
}
