//! A session: one cloth, its frames and its corrections.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use pyo3::{exceptions::PyValueError, prelude::*};
use untangled_client::{
    Client, ClientOptions, CorrectionKind, FrameRefusal, Loan, Precision, Registration, RepairError, Session, Status,
    StepTime, Uvs, WaitError,
};
use untangled_proto::limits;

use crate::{
    bytes::{f64s, u32s},
    correction::NativeCorrection,
    error::{self, Error},
    memory::Memory,
    repair::NativeRepair,
};

/// Longest wait between two checks for Ctrl-C.
pub(crate) const SLICE: Duration = Duration::from_millis(100);

/// A session, until it is closed.
#[pyclass(frozen, module = "untangled_cloth._native")]
pub(crate) struct NativeSession(Mutex<Option<Open>>);

/// Fields are dropped in order.
struct Open {
    loan: Option<Loan>,
    session: Session,
}

#[pymethods]
impl NativeSession {
    /// Connects and registers. Arrays are bytes: indices of u32, numbers of f64.
    #[new]
    #[pyo3(signature = (
        domain, timeout_s, num_vertices, triangles, uvs, uv_corners, rest_positions, masses, pins, layers, body, double,
        kind, paths, sparse, labels, repairs, weld, settings
    ))]
    #[expect(clippy::too_many_arguments, reason = "Python names them")]
    fn new(
        py: Python<'_>,
        domain: Option<String>,
        timeout_s: f64,
        num_vertices: usize,
        triangles: &[u8],
        uvs: Option<&[u8]>,
        uv_corners: Option<&[u8]>,
        rest_positions: Option<&[u8]>,
        masses: Option<&[u8]>,
        pins: &[u8],
        layers: Option<&[u8]>,
        body: &[u8],
        double: bool,
        kind: &str,
        paths: bool,
        sparse: bool,
        labels: bool,
        repairs: bool,
        weld: bool,
        settings: &str,
    ) -> PyResult<Self> {
        let uvs = match (uvs, uv_corners) {
            (Some(uvs), Some(corners)) => {
                Some(Uvs { coordinates: f64s("uv", uvs)?, corners: u32s("uv_triangles", corners)? })
            }
            _ => None,
        };
        let rest_positions = rest_positions.map(|bytes| f64s("rest_positions", bytes)).transpose()?;
        let masses = masses.map(|bytes| f64s::<1>("masses", bytes)).transpose()?;
        let layers = layers.map(|bytes| u32s::<1>("layers", bytes)).transpose()?;
        let registration = Registration {
            num_vertices,
            triangles: u32s("triangles", triangles)?,
            uvs,
            rest_positions,
            masses_kg: masses.map(|masses| masses.into_flattened()),
            pins: u32s::<1>("pins", pins)?.into_flattened(),
            layers: layers.map(|layers| layers.into_flattened()),
            body: u32s::<1>("body", body)?.into_flattened(),
            precision: if double { Precision::F64 } else { Precision::F32 },
            correction: correction_kind(kind)?,
            sparse,
            labels,
            paths,
            repairs,
            weld,
            settings: parse(settings)?,
        };
        let timeout = seconds(timeout_s)?;
        let session = py.detach(|| {
            let client = Client::connect(ClientOptions { domain, timeout }).map_err(error::connect)?;
            client.register(registration).map_err(error::register)
        })?;
        Ok(Self(Mutex::new(Some(Open { loan: None, session }))))
    }

    /// Lends the memory of the next frame's positions, which replaces a frame that was begun and not sent.
    fn begin(&self, py: Python<'_>, simulated_s: f64, dt_s: f64) -> PyResult<Memory> {
        py.detach(|| {
            self.with(|open| {
                // Before the daemon sees it, so that neither a frame nor time is spent on it.
                check_step(open.session.frame() + 1, simulated_s, dt_s)?;
                open.loan = None;
                let mut loan = open.session.loan(StepTime { simulated_s, dt_s }).map_err(error::publish)?;
                let owner = Arc::new(loan.memory());
                let memory = if let Some(slots) = loan.positions_f32() {
                    Memory::new(slots.as_ptr(), [slots.len(), 3, 12], "<f4", true, owner)
                } else if let Some(slots) = loan.positions_f64() {
                    Memory::new(slots.as_ptr(), [slots.len(), 3, 24], "<f8", true, owner)
                } else {
                    return Err(Error::new_err("positions of no precision"));
                };
                open.loan = Some(loan);
                Ok(memory)
            })
        })
    }

    /// Sends the frame that was begun and returns its number.
    fn send(&self, py: Python<'_>) -> PyResult<u64> {
        py.detach(|| {
            self.with(|open| {
                let loan = open.loan.take().ok_or_else(|| Error::new_err("no frame was begun"))?;
                open.session.send(loan).map_err(error::publish)
            })
        })
    }

    /// Drops the frame that was begun, if one was.
    fn abandon(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            self.with(|open| {
                open.loan = None;
                Ok(())
            })
        })
    }

    /// Waits for the correction of a frame.
    fn wait(&self, py: Python<'_>, frame: u64, deadline_s: f64) -> PyResult<NativeCorrection> {
        let begin = Instant::now();
        let deadline = seconds(deadline_s)?;
        loop {
            let left = deadline.saturating_sub(begin.elapsed());
            let answer = py.detach(|| self.with(|open| Ok(open.session.wait(frame, left.min(SLICE)))))?;
            match answer {
                Ok(correction) => return Ok(NativeCorrection::new(correction)),
                Err(WaitError::Timeout { .. }) if begin.elapsed() < deadline => py.check_signals()?,
                Err(WaitError::Timeout { .. }) => {
                    return Err(error::wait(WaitError::Timeout { frame, waited: begin.elapsed() }));
                }
                Err(error) => return Err(error::wait(error)),
            }
        }
    }

    /// The newest correction that has come since the last call, if any.
    fn newest(&self, py: Python<'_>) -> PyResult<Option<NativeCorrection>> {
        let newest = py.detach(|| self.with(|open| open.session.newest().map_err(error::newest)))?;
        Ok(newest.map(NativeCorrection::new))
    }

    /// Whether it was registered with repairs, by a daemon that knows them.
    #[getter]
    fn has_repairs(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| self.with(|open| Ok(open.session.has_repairs())))
    }

    /// Asks for a repair of the next frame.
    fn ask_for_repair(&self, py: Python<'_>, time_s: Option<f64>) -> PyResult<()> {
        let time = time_s.map(seconds).transpose()?;
        py.detach(|| {
            self.with(|open| {
                if !open.session.has_repairs() {
                    return Err(error::repair(RepairError::NotOffered));
                }
                open.session.ask_for_repair(time);
                Ok(())
            })
        })
    }

    /// Waits for the repair of a frame.
    fn wait_repair(&self, py: Python<'_>, frame: u64, deadline_s: f64) -> PyResult<NativeRepair> {
        let begin = Instant::now();
        let deadline = seconds(deadline_s)?;
        loop {
            let left = deadline.saturating_sub(begin.elapsed());
            let answer = py.detach(|| self.with(|open| Ok(open.session.wait_repair(frame, left.min(SLICE)))))?;
            match answer {
                Ok(repair) => return Ok(NativeRepair::new(repair)),
                Err(RepairError::Timeout { .. }) if begin.elapsed() < deadline => py.check_signals()?,
                Err(RepairError::Timeout { .. }) => {
                    return Err(error::repair(RepairError::Timeout { frame, waited: begin.elapsed() }));
                }
                Err(error) => return Err(error::repair(error)),
            }
        }
    }

    /// The newest repair that has come since the last call, if any.
    fn poll_repair(&self, py: Python<'_>) -> PyResult<Option<NativeRepair>> {
        let newest = py.detach(|| self.with(|open| open.session.poll_repair().map_err(error::repair)))?;
        Ok(newest.map(NativeRepair::new))
    }

    /// The next frame is no continuation of those before.
    fn begin_motion(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            self.with(|open| {
                open.session.begin_motion();
                Ok(())
            })
        })
    }

    /// Replaces the settings from the next frame on.
    fn update_settings(&self, py: Python<'_>, settings: &str, timeout_s: f64) -> PyResult<()> {
        let (settings, timeout) = (parse(settings)?, seconds(timeout_s)?);
        py.detach(|| self.with(|open| open.session.update_settings(settings, timeout).map_err(error::request)))
    }

    /// Number of the last frame that was sent.
    #[getter]
    fn frame(&self, py: Python<'_>) -> PyResult<u64> {
        py.detach(|| self.with(|open| Ok(open.session.frame())))
    }

    /// How often the session was registered.
    #[getter]
    fn num_registrations(&self, py: Python<'_>) -> PyResult<u32> {
        py.detach(|| self.with(|open| Ok(open.session.num_registrations())))
    }

    /// Vertices that became one with an earlier one in their place.
    #[getter]
    fn num_welded_vertices(&self, py: Python<'_>) -> PyResult<usize> {
        py.detach(|| self.with(|open| Ok(open.session.num_welded_vertices())))
    }

    /// Whether corrections come sparse.
    #[getter]
    fn is_sparse(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| self.with(|open| Ok(open.session.is_sparse())))
    }

    /// Whether corrections have labels.
    #[getter]
    fn has_labels(&self, py: Python<'_>) -> PyResult<bool> {
        py.detach(|| self.with(|open| Ok(open.session.has_labels())))
    }

    /// How long to wait where the caller does not say.
    #[getter]
    fn default_deadline_s(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| self.with(|open| Ok(open.session.default_deadline().as_secs_f64())))
    }

    /// Ends the session and tells the daemon; one that does not take note finds out by itself.
    fn close(&self, py: Python<'_>, timeout_s: f64) -> PyResult<()> {
        let timeout = seconds(timeout_s)?;
        py.detach(|| {
            let open = self.lock().take();
            if let Some(Open { loan, session }) = open {
                drop(loan);
                let _ = session.close(timeout);
            }
        });
        Ok(())
    }
}

impl NativeSession {
    /// Must not be called while the interpreter's lock is held, since the holder of this lock may be waiting.
    fn lock(&self) -> MutexGuard<'_, Option<Open>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<T>(&self, call: impl FnOnce(&mut Open) -> PyResult<T>) -> PyResult<T> {
        call(self.lock().as_mut().ok_or_else(|| Error::new_err("the session is closed"))?)
    }
}

/// What the daemon would say of a frame's times.
fn check_step(frame: u64, simulated_s: f64, dt_s: f64) -> PyResult<()> {
    let (field, fault_value) = if !(limits::MIN_DT_S..=limits::MAX_DT_S).contains(&dt_s) {
        ("dt_s", dt_s)
    } else if !simulated_s.is_finite() {
        ("simulated_s", simulated_s)
    } else {
        return Ok(());
    };
    let status = Status::BadHeader;
    Err(error::refused(FrameRefusal { frame, status, fault_index: None, fault_value, header_field: Some(field) }))
}

fn correction_kind(name: &str) -> PyResult<CorrectionKind> {
    match name {
        "force" => Ok(CorrectionKind::Force),
        "acceleration" => Ok(CorrectionKind::Acceleration),
        "velocity" => Ok(CorrectionKind::VelocityChange),
        "displacement" => Ok(CorrectionKind::Displacement),
        other => Err(PyValueError::new_err(format!(
            "correction must be one of force, acceleration, velocity, displacement, not '{other}'"
        ))),
    }
}

/// The state of a domain's daemon as JSON.
#[pyfunction]
pub(crate) fn status(py: Python<'_>, domain: Option<String>, timeout_s: f64) -> PyResult<String> {
    let timeout = seconds(timeout_s)?;
    py.detach(|| {
        let client = Client::connect(ClientOptions { domain, timeout }).map_err(error::connect)?;
        client.status().map(|status| status.to_string()).map_err(error::request)
    })
}

/// A duration, at most a year.
pub(crate) fn seconds(seconds: f64) -> PyResult<Duration> {
    if seconds.is_nan() || seconds < 0.0 {
        return Err(PyValueError::new_err(format!("{seconds} seconds are no length of time to wait")));
    }
    Ok(Duration::from_secs_f64(seconds.min(3.2e7)))
}

/// Settings from JSON.
pub(crate) fn parse(settings: &str) -> PyResult<serde_json::Value> {
    serde_json::from_str(settings).map_err(|error| PyValueError::new_err(format!("settings: {error}")))
}
