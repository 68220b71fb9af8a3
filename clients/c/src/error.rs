//! Error codes, and their messages by thread.

use std::{
    cell::RefCell,
    ffi::c_char,
    fmt::{Display, Write},
    panic::{AssertUnwindSafe, catch_unwind},
};

use client::{
    ConnectError, ExchangeError, FrameRefusal, NewestError, PublishError, RegisterError, RepairError, RequestError,
    WaitError,
};

/// What became of a call. `untangled_last_error` says it in words.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorCode {
    /// Done.
    Ok = 0,
    /// An argument is null, not aligned, too long, of the wrong length, or no such code.
    InvalidArgument = 1,
    /// The handle was closed or released, or never was one.
    InvalidHandle = 2,
    /// A frame was begun and neither sent nor abandoned.
    FrameOpen = 3,
    /// No frame was begun.
    NoFrame = 4,
    /// The session was registered with the other precision.
    Precision = 5,
    /// No daemon serves the domain.
    NoDaemon = 6,
    /// The daemon runs another version of iceoryx2 or of the protocol.
    Version = 7,
    /// The domain can't be used.
    Domain = 8,
    /// It did not come in time. Go on without.
    Timeout = 9,
    /// The daemon refused a request; the message names the element and the value at fault.
    Refused = 10,
    /// Shared memory is too full.
    NotEnoughMemory = 11,
    /// The transport failed.
    Transport = 12,
    /// The daemon went away, and has not yet taken the session up again. Go on without, and try again with the next
    /// frame.
    Reconnecting = 13,
    /// The daemon went away while it was waited for. Go on without; the next frame registers the session again.
    DaemonLost = 14,
    /// The daemon went on to a newer frame. Go on without.
    Overtaken = 15,
    /// The daemon could not use the frame; the message names the vertex and the value at fault. The session lives on.
    FrameRefused = 16,
    /// Nothing has come since the last call.
    NothingNew = 17,
    /// As many corrections are held as a session may hold: release one.
    TooManyCorrections = 18,
    /// Something in this library failed that should not.
    Internal = 19,
    /// The daemon ended the frame at a limit of time or of intersections, before there was a correction. Go on without.
    NotAnalysed = 20,
    /// The session has no repairs: it was registered without `UNTANGLED_REPAIRS`, or by a daemon that does not know
    /// them.
    NoRepairs = 21,
}

/// Longest message in bytes, its end included; a longer one is cut.
const MESSAGE_BYTES: usize = 512;

thread_local! {
    static MESSAGE: RefCell<Message> = const { RefCell::new(Message { bytes: [0; MESSAGE_BYTES], length: 0 }) };
}

/// A message that ends in a zero byte and has none before it.
struct Message {
    bytes: [u8; MESSAGE_BYTES],
    length: usize,
}

impl Write for Message {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for character in text.chars().map(|character| if character == '\0' { ' ' } else { character }) {
            let end = self.length + character.len_utf8();
            if end >= MESSAGE_BYTES {
                break;
            }
            character.encode_utf8(&mut self.bytes[self.length..end]);
            self.length = end;
        }
        self.bytes[self.length] = 0;
        Ok(())
    }
}

/// A code whose message is already kept.
#[derive(Debug)]
pub(crate) struct Fault(ErrorCode);

impl Fault {
    pub(crate) fn new(code: ErrorCode, message: impl Display) -> Self {
        MESSAGE.with_borrow_mut(|kept| {
            kept.length = 0;
            // Writing into the buffer does not fail; where a `Display` fails, the message ends there.
            let _ = write!(kept, "{message}");
        });
        Self(code)
    }

    pub(crate) fn argument(message: impl Display) -> Self {
        Self::new(ErrorCode::InvalidArgument, message)
    }
}

/// Runs a call and returns its code; catches panics.
pub(crate) fn guard(call: impl FnOnce() -> Result<(), Fault>) -> ErrorCode {
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => ErrorCode::Ok,
        Ok(Err(Fault(code))) => code,
        Err(_) => Fault::new(ErrorCode::Internal, "a defect of the client library; it is written to standard error").0,
    }
}

/// Why the last call of this thread that failed did so, in words, UTF-8. It is valid until the next call of this
/// thread.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_last_error() -> *const c_char {
    MESSAGE.with_borrow(|kept| kept.bytes.as_ptr().cast())
}

/// Whether a simulation should go on without help for this step, and try again with the next one.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_is_transient(code: i32) -> bool {
    use ErrorCode::{DaemonLost, NotAnalysed, Overtaken, Reconnecting, Timeout};
    [Timeout, Reconnecting, DaemonLost, Overtaken, NotAnalysed].iter().any(|&transient| transient as i32 == code)
}

impl From<RequestError> for Fault {
    fn from(error: RequestError) -> Self {
        let code = match error {
            RequestError::NoDaemon { .. } => ErrorCode::NoDaemon,
            RequestError::Timeout { .. } => ErrorCode::Timeout,
            RequestError::Refused { .. } => ErrorCode::Refused,
            RequestError::NotEnoughMemory { .. } => ErrorCode::NotEnoughMemory,
            RequestError::Transport { .. } => ErrorCode::Transport,
        };
        Self::new(code, error)
    }
}

impl From<ConnectError> for Fault {
    fn from(error: ConnectError) -> Self {
        match error {
            ConnectError::Domain(error) => Self::new(ErrorCode::Domain, error),
            ConnectError::Version { .. } => Self::new(ErrorCode::Version, error),
            ConnectError::Request(error) => error.into(),
        }
    }
}

impl From<RegisterError> for Fault {
    fn from(error: RegisterError) -> Self {
        let RegisterError::Request(error) = error;
        error.into()
    }
}

impl From<PublishError> for Fault {
    fn from(error: PublishError) -> Self {
        match error {
            PublishError::Reconnecting => Self::new(ErrorCode::Reconnecting, error),
            PublishError::Request(error) => error.into(),
            PublishError::Precision { .. } => Self::new(ErrorCode::Precision, error),
        }
    }
}

impl From<FrameRefusal> for Fault {
    fn from(error: FrameRefusal) -> Self {
        let code = if error.is_transient() { ErrorCode::NotAnalysed } else { ErrorCode::FrameRefused };
        Self::new(code, error)
    }
}

impl From<WaitError> for Fault {
    fn from(error: WaitError) -> Self {
        let code = match error {
            WaitError::Timeout { .. } => ErrorCode::Timeout,
            WaitError::DaemonLost { .. } => ErrorCode::DaemonLost,
            WaitError::Overtaken { .. } => ErrorCode::Overtaken,
            WaitError::Refused(error) => return error.into(),
            WaitError::Receive { .. } => ErrorCode::Transport,
        };
        Self::new(code, error)
    }
}

impl From<NewestError> for Fault {
    fn from(error: NewestError) -> Self {
        match error {
            NewestError::Refused(error) => error.into(),
            NewestError::Receive { .. } => Self::new(ErrorCode::Transport, error),
        }
    }
}

impl From<RepairError> for Fault {
    fn from(error: RepairError) -> Self {
        let code = match error {
            RepairError::NotOffered => ErrorCode::NoRepairs,
            RepairError::Publish(error) => return error.into(),
            RepairError::Timeout { .. } => ErrorCode::Timeout,
            RepairError::DaemonLost { .. } => ErrorCode::DaemonLost,
            RepairError::Overtaken { .. } => ErrorCode::Overtaken,
            RepairError::Refused(error) => return error.into(),
            RepairError::Receive { .. } => ErrorCode::Transport,
        };
        Self::new(code, error)
    }
}

impl From<ExchangeError> for Fault {
    fn from(error: ExchangeError) -> Self {
        match error {
            ExchangeError::Publish(error) => error.into(),
            ExchangeError::Wait(error) => error.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn last() -> String {
        // SAFETY: the message ends in a zero byte and lives as long as the thread.
        unsafe { CStr::from_ptr(untangled_last_error()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn guard_turns_panic_into_code_and_cuts_messages_between_characters() {
        assert_eq!(guard(|| panic!("on purpose")), ErrorCode::Internal);
        assert!(last().contains("defect"));
        let long = "a\0ö".repeat(MESSAGE_BYTES);
        assert_eq!(guard(|| Err(Fault::argument(long))), ErrorCode::InvalidArgument);
        assert_eq!(last(), "a ö".repeat(127) + "a ");
        assert_eq!(guard(|| Err(Fault::argument("short"))), ErrorCode::InvalidArgument);
        assert_eq!(last(), "short");
    }
}
