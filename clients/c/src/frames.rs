//! The calls of a frame. None of them allocates in this crate, or blocks beyond a deadline that the caller gave.

use std::time::Duration;

use client::{Correction, Loan, Precision, PublishError, StepTime};

use crate::{
    error::{ErrorCode, Fault, guard},
    handles::{OpenSession, SESSIONS, lock},
    input,
    types::{CorrectionView, SessionHandle},
};

/// Begins a frame of a session in single precision: `positions` becomes the address of `num_vertices x 3` numbers in
/// shared memory, in metres. They hold what an earlier frame left there: write all of them, then call
/// `untangled_send_frame`. One frame at a time.
///
/// # Safety
/// `positions` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_begin_frame(
    session: SessionHandle,
    simulated_s: f64,
    dt_s: f64,
    positions: *mut *mut f32,
) -> ErrorCode {
    let first = |loan: &mut Loan| loan.positions_f32().map(|slots| slots.as_mut_ptr().cast());
    // SAFETY: the caller's promise.
    unsafe { begin(session, StepTime { simulated_s, dt_s }, positions, first, Precision::F64) }
}

/// `untangled_begin_frame` of a session in double precision.
///
/// # Safety
/// `positions` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_begin_frame_f64(
    session: SessionHandle,
    simulated_s: f64,
    dt_s: f64,
    positions: *mut *mut f64,
) -> ErrorCode {
    let first = |loan: &mut Loan| loan.positions_f64().map(|slots| slots.as_mut_ptr().cast());
    // SAFETY: the caller's promise.
    unsafe { begin(session, StepTime { simulated_s, dt_s }, positions, first, Precision::F32) }
}

/// Lends a frame and writes the address of its positions, which `first` finds unless the session has the `other`
/// precision.
///
/// # Safety
/// `positions` is null or may be written.
unsafe fn begin<T>(
    session: SessionHandle,
    step: StepTime,
    positions: *mut *mut T,
    first: impl FnOnce(&mut Loan) -> Option<*mut T>,
    other: Precision,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("positions", positions) }?;
        place.write(std::ptr::null_mut());
        with(session, |open| {
            let mut loan = open.session.loan(step)?;
            place.write(first(&mut loan).ok_or(PublishError::Precision { registered: other })?);
            open.loan = Some(loan);
            Ok(())
        })
    })
}

/// Sends the frame that was begun; its number goes to `frame`, unless that is null. The positions must not be used any
/// more, also after an error, except `UNTANGLED_INVALID_ARGUMENT`, which leaves the frame begun.
///
/// # Safety
/// `frame` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_send_frame(session: SessionHandle, frame: *mut u64) -> ErrorCode {
    guard(|| {
        // Before anything is sent, so that a frame that is sent has no error.
        // SAFETY: the caller's promise.
        let place = if frame.is_null() { None } else { Some(unsafe { input::place("frame", frame) }?) };
        let session = SESSIONS.get(session.id)?;
        let mut open = lock(&session);
        let loan = open.loan.take().ok_or_else(no_frame)?;
        let number = open.session.send(loan)?;
        if let Some(place) = place {
            place.write(number);
        }
        Ok(())
    })
}

/// Drops the frame that was begun. The positions must not be used any more.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_abandon_frame(session: SessionHandle) -> ErrorCode {
    guard(|| {
        let session = SESSIONS.get(session.id)?;
        let loan = lock(&session).loan.take();
        loan.map(drop).ok_or_else(no_frame)
    })
}

/// Waits for the correction of a frame, up to `deadline_us` microseconds. Release what it wrote to `correction`; a
/// session can hold three.
///
/// # Safety
/// `correction` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_wait(
    session: SessionHandle,
    frame: u64,
    deadline_us: u64,
    correction: *mut CorrectionView,
) -> ErrorCode {
    let receive = |open: &mut OpenSession| Ok(open.session.wait(frame, Duration::from_micros(deadline_us))?);
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, correction, receive) }
}

/// The newest correction that has come since the last call; `UNTANGLED_NOTHING_NEW` where none has. Does not block.
///
/// # Safety
/// `correction` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_newest(session: SessionHandle, correction: *mut CorrectionView) -> ErrorCode {
    let receive = |open: &mut OpenSession| {
        let nothing = || Fault::new(ErrorCode::NothingNew, "no correction has come since the last call");
        open.session.newest()?.ok_or_else(nothing)
    };
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, correction, receive) }
}

/// Copies `num_vertices x 3` positions into a frame, sends it, and waits for its correction: lock step in one call, for
/// hosts that keep their positions elsewhere. `num_vertices` must be the session's.
///
/// # Safety
/// `positions` is null or holds `num_vertices x 3` numbers; `correction` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_exchange(
    session: SessionHandle,
    simulated_s: f64,
    dt_s: f64,
    positions: *const f32,
    num_vertices: usize,
    deadline_us: u64,
    correction: *mut CorrectionView,
) -> ErrorCode {
    let receive = |open: &mut OpenSession| {
        check_no_frame(open)?;
        let expected = open.session.num_vertices();
        if num_vertices != expected {
            return Err(Fault::argument(format_args!("`num_vertices` is {num_vertices}; the session has {expected}")));
        }
        // SAFETY: the caller's promise; the daemon registered no more vertices than memory holds.
        let positions = unsafe { input::array("positions", positions, 3 * num_vertices, usize::MAX) }?;
        let step = StepTime { simulated_s, dt_s };
        let deadline = Duration::from_micros(deadline_us);
        Ok(open.session.exchange(step, deadline, |slots| slots.as_flattened_mut().copy_from_slice(positions))?)
    };
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, correction, receive) }
}

/// Gives a correction back, and clears it. Its addresses must not be used any more.
///
/// # Safety
/// `correction` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_release(session: SessionHandle, correction: *mut CorrectionView) -> ErrorCode {
    guard(|| {
        if correction.is_null() || !correction.is_aligned() {
            return Err(Fault::argument("`correction` is null or not aligned"));
        }
        // SAFETY: checked as far as it can be; the rest is the caller's promise.
        let view = unsafe { &mut *correction };
        let token = std::mem::take(&mut view.token);
        view.vertices = std::ptr::null();
        view.paths = std::ptr::null();
        view.path_points = std::ptr::null();
        (view.num_vertices, view.num_paths, view.num_path_points) = (0, 0, 0);
        lock(&*SESSIONS.get(session.id)?).release(token)
    })
}

/// Runs a call that begins a frame, where none is begun.
fn with(session: SessionHandle, begin: impl FnOnce(&mut OpenSession) -> Result<(), Fault>) -> Result<(), Fault> {
    let session = SESSIONS.get(session.id)?;
    let mut open = lock(&session);
    check_no_frame(&open)?;
    begin(&mut open)
}

/// Receives a correction, keeps it, and writes its view to the caller's address.
///
/// # Safety
/// `correction` is null or may be written.
unsafe fn receive_into(
    session: SessionHandle,
    correction: *mut CorrectionView,
    receive: impl FnOnce(&mut OpenSession) -> Result<Correction, Fault>,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("correction", correction) }?;
        // SAFETY: zero is a value of all its fields: numbers and addresses.
        place.write(unsafe { std::mem::zeroed() });
        let session = SESSIONS.get(session.id)?;
        let mut open = lock(&session);
        open.check_room()?;
        let received = receive(&mut open)?;
        let (token, held) = open.hold(received)?;
        place.write(CorrectionView::new(held, token));
        Ok(())
    })
}

fn check_no_frame(open: &OpenSession) -> Result<(), Fault> {
    if open.loan.is_some() {
        return Err(Fault::new(ErrorCode::FrameOpen, "a frame is begun; send or abandon it first"));
    }
    Ok(())
}

fn no_frame() -> Fault {
    Fault::new(ErrorCode::NoFrame, "no frame was begun")
}
