//! Exceptions.

use pyo3::{create_exception, exceptions::PyException, prelude::*};
use untangled_client::{
    ConnectError, FrameRefusal, NewestError, PublishError, RegisterError, RepairError, RequestError, WaitError,
    observe::ObserveError,
};

create_exception!(untangled_cloth, Error, PyException, "What all errors of this package are.");
create_exception!(untangled_cloth, NoDaemon, Error, "No daemon serves the domain.");
create_exception!(
    untangled_cloth,
    Refused,
    Error,
    "The daemon refused; the message names the element and the value at fault."
);
create_exception!(
    untangled_cloth,
    FrameRefused,
    Error,
    "The frame can't be used; the message names the vertex, or the field, and the value at fault. `frame` is its \
     number. The session lives on."
);
create_exception!(
    untangled_cloth,
    Missed,
    Error,
    "No correction for this frame: it did not come in time, the daemon ended the frame at a limit of time or of \
     intersections, or it went away or on to a newer frame. Go on without it; the next frame tries again, and \
     registers again by itself."
);

create_exception!(untangled_cloth, SessionEnded, Error, "The session that was watched has ended, or its daemon.");

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("Error", py.get_type::<Error>())?;
    module.add("NoDaemon", py.get_type::<NoDaemon>())?;
    module.add("Refused", py.get_type::<Refused>())?;
    module.add("FrameRefused", py.get_type::<FrameRefused>())?;
    module.add("Missed", py.get_type::<Missed>())?;
    module.add("SessionEnded", py.get_type::<SessionEnded>())
}

pub(crate) fn request(error: RequestError) -> PyErr {
    let message = error.to_string();
    match error {
        RequestError::NoDaemon { .. } => NoDaemon::new_err(message),
        RequestError::Refused { .. } | RequestError::NotEnoughMemory { .. } => Refused::new_err(message),
        RequestError::Timeout { .. } | RequestError::Transport { .. } => Error::new_err(message),
    }
}

pub(crate) fn connect(error: ConnectError) -> PyErr {
    match error {
        ConnectError::Request(error) => request(error),
        other => Error::new_err(other.to_string()),
    }
}

pub(crate) fn observe(error: ObserveError) -> PyErr {
    let message = error.to_string();
    match error {
        ObserveError::Connect(error) => connect(error),
        ObserveError::Request(error) => request(error),
        ObserveError::TooOld { .. } | ObserveError::TooMany { .. } => Refused::new_err(message),
        ObserveError::SessionEnded { .. } | ObserveError::DaemonGone { .. } => SessionEnded::new_err(message),
        ObserveError::Malformed { .. } => Error::new_err(message),
    }
}

pub(crate) fn register(error: RegisterError) -> PyErr {
    let RegisterError::Request(error) = error;
    request(error)
}

pub(crate) fn publish(error: PublishError) -> PyErr {
    match error {
        PublishError::Reconnecting => Missed::new_err(error.to_string()),
        PublishError::Request(error) => request(error),
        PublishError::Precision { .. } => Error::new_err(error.to_string()),
    }
}

pub(crate) fn wait(error: WaitError) -> PyErr {
    match error {
        WaitError::Timeout { .. } | WaitError::DaemonLost { .. } | WaitError::Overtaken { .. } => {
            Missed::new_err(error.to_string())
        }
        WaitError::Refused(error) => refused(error),
        WaitError::Receive { .. } => receive(&error),
    }
}

pub(crate) fn newest(error: NewestError) -> PyErr {
    match error {
        NewestError::Refused(error) => refused(error),
        NewestError::Receive { .. } => receive(&error),
    }
}

pub(crate) fn repair(error: RepairError) -> PyErr {
    match error {
        RepairError::Publish(error) => publish(error),
        RepairError::Timeout { .. } | RepairError::DaemonLost { .. } | RepairError::Overtaken { .. } => {
            Missed::new_err(error.to_string())
        }
        RepairError::Refused(error) => refused(error),
        RepairError::NotOffered | RepairError::Receive { .. } => Error::new_err(error.to_string()),
    }
}

/// A frame that was refused, with its number as the attribute `frame`; or one that was only not analysed.
pub(crate) fn refused(error: FrameRefusal) -> PyErr {
    if error.is_transient() {
        return Missed::new_err(error.to_string());
    }
    let raised = FrameRefused::new_err(error.to_string());
    let named = Python::attach(|py| raised.value(py).setattr("frame", error.frame));
    named.err().unwrap_or(raised)
}

fn receive(error: &impl std::fmt::Display) -> PyErr {
    Error::new_err(format!(
        "{error}; a session lends three corrections at a time. Arrays that look into a correction hold it; \
         copy what is to be kept"
    ))
}
