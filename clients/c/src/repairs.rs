//! Repairs: one exchange from a tangled cloth to one that is certified clean.

use std::time::Duration;

use client::{Repair, StepTime};

use crate::{
    error::{ErrorCode, Fault, guard},
    handles::{OpenSession, SESSIONS, lock},
    input,
    types::{RepairView, SessionHandle},
};

/// Whether a session has repairs: where it was registered with `UNTANGLED_REPAIRS`, by a daemon that knows them.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_has_repairs(session: SessionHandle) -> bool {
    SESSIONS.get(session.id).is_ok_and(|session| lock(&session).session.has_repairs())
}

/// Asks for a repair of the next frame that is sent, by whatever call. Its correction comes as ever; the repair comes
/// beside it when it is done, see `untangled_poll_repair`. With `time_us` the daemon sends the best state so far early
/// enough to be here within that time; with 0 the setting `repair_deadline_us` limits it.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_ask_for_repair(session: SessionHandle, time_us: u64) -> ErrorCode {
    guard(|| {
        let time = Some(time_us).filter(|&time| time > 0).map(Duration::from_micros);
        lock(&*SESSIONS.get(session.id)?).session.ask_for_repair(time);
        Ok(())
    })
}

/// The newest repair that has come since the last call; `UNTANGLED_NOTHING_NEW` where none has. Does not block. Add its
/// displacements to the positions of its frame, or to those of now. What was handed out is taken as added: repairs of
/// frames that were sent before are dropped. Release what it wrote to `repair`; a session can hold one.
///
/// # Safety
/// `repair` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_poll_repair(session: SessionHandle, repair: *mut RepairView) -> ErrorCode {
    let receive = |open: &mut OpenSession| {
        let nothing = || Fault::new(ErrorCode::NothingNew, "no repair has come since the last call");
        open.session.poll_repair()?.ok_or_else(nothing)
    };
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, repair, receive) }
}

/// Waits for the repair of a frame, up to `deadline_us` microseconds. Release what it wrote to `repair`.
///
/// # Safety
/// `repair` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_wait_repair(
    session: SessionHandle,
    frame: u64,
    deadline_us: u64,
    repair: *mut RepairView,
) -> ErrorCode {
    let receive = |open: &mut OpenSession| Ok(open.session.wait_repair(frame, Duration::from_micros(deadline_us))?);
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, repair, receive) }
}

/// Copies `num_vertices x 3` positions into a frame that asks for a repair, sends it, and waits for that: one exchange
/// from a tangled cloth to one that is certified clean, or to the best that is reached within the deadline.
/// `num_vertices` must be the session's. Release what it wrote to `repair`.
///
/// # Safety
/// `positions` is null or holds `num_vertices x 3` numbers; `repair` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_exchange_repair(
    session: SessionHandle,
    simulated_s: f64,
    dt_s: f64,
    positions: *const f32,
    num_vertices: usize,
    deadline_us: u64,
    repair: *mut RepairView,
) -> ErrorCode {
    let step = StepTime { simulated_s, dt_s };
    let receive = |open: &mut OpenSession| {
        // SAFETY: the caller's promise.
        let positions = unsafe { positions_of(open, positions, num_vertices) }?;
        let fill = |slots: &mut [[f32; 3]]| slots.as_flattened_mut().copy_from_slice(positions);
        Ok(open.session.repair(step, Duration::from_micros(deadline_us), fill)?)
    };
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, repair, receive) }
}

/// `untangled_exchange_repair` of a session in double precision.
///
/// # Safety
/// `positions` is null or holds `num_vertices x 3` numbers; `repair` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_exchange_repair_f64(
    session: SessionHandle,
    simulated_s: f64,
    dt_s: f64,
    positions: *const f64,
    num_vertices: usize,
    deadline_us: u64,
    repair: *mut RepairView,
) -> ErrorCode {
    let step = StepTime { simulated_s, dt_s };
    let receive = |open: &mut OpenSession| {
        // SAFETY: the caller's promise.
        let positions = unsafe { positions_of(open, positions, num_vertices) }?;
        let fill = |slots: &mut [[f64; 3]]| slots.as_flattened_mut().copy_from_slice(positions);
        Ok(open.session.repair_f64(step, Duration::from_micros(deadline_us), fill)?)
    };
    // SAFETY: the caller's promise.
    unsafe { receive_into(session, repair, receive) }
}

/// Gives a repair back, and clears it. Its addresses must not be used any more.
///
/// # Safety
/// `repair` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_release_repair(session: SessionHandle, repair: *mut RepairView) -> ErrorCode {
    guard(|| {
        if repair.is_null() || !repair.is_aligned() {
            return Err(Fault::argument("`repair` is null or not aligned"));
        }
        // SAFETY: checked as far as it can be; the rest is the caller's promise.
        let view = unsafe { &mut *repair };
        let token = std::mem::take(&mut view.token);
        (view.displacements, view.displacements_f64) = (std::ptr::null(), std::ptr::null());
        view.num_vertices = 0;
        lock(&*SESSIONS.get(session.id)?).release_repair(token)
    })
}

/// Says that the next frame is no continuation of those before: with the setting `repair` = `auto` the daemon then
/// begins anew to judge progress.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_begin_motion(session: SessionHandle) -> ErrorCode {
    guard(|| {
        lock(&*SESSIONS.get(session.id)?).session.begin_motion();
        Ok(())
    })
}

/// The caller's positions, where they are as many as the session has.
///
/// # Safety
/// `positions` is null or holds `num_vertices x 3` numbers.
unsafe fn positions_of<'a, T: Copy>(
    open: &OpenSession,
    positions: *const T,
    num_vertices: usize,
) -> Result<&'a [T], Fault> {
    if open.loan.is_some() {
        return Err(Fault::new(ErrorCode::FrameOpen, "a frame is begun; send or abandon it first"));
    }
    let expected = open.session.num_vertices();
    if num_vertices != expected {
        return Err(Fault::argument(format_args!("`num_vertices` is {num_vertices}; the session has {expected}")));
    }
    // SAFETY: the caller's promise; the daemon registered no more vertices than memory holds.
    unsafe { input::array("positions", positions, 3 * num_vertices, usize::MAX) }
}

/// Receives a repair, keeps it, and writes its view to the caller's address.
///
/// # Safety
/// `repair` is null or may be written.
unsafe fn receive_into(
    session: SessionHandle,
    repair: *mut RepairView,
    receive: impl FnOnce(&mut OpenSession) -> Result<Repair, Fault>,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("repair", repair) }?;
        // SAFETY: zero is a value of all its fields: numbers and addresses.
        place.write(unsafe { std::mem::zeroed() });
        let session = SESSIONS.get(session.id)?;
        let mut open = lock(&session);
        open.check_room_for_repair()?;
        let received = receive(&mut open)?;
        let (token, held) = open.hold_repair(received);
        place.write(RepairView::new(held, token));
        Ok(())
    })
}
