//! Calls for connections and sessions: connect, register, settings, status, close.

use std::{
    ffi::c_char,
    sync::{Arc, PoisonError},
    time::Duration,
};

use client::{Client, ClientOptions};

use crate::{
    error::{ErrorCode, Fault, guard},
    handles::{CLIENTS, OpenSession, SESSIONS, lock},
    input,
    registration::{ClothRegistration, MOST, parse},
    types::{ClientHandle, SessionHandle},
};

/// The version of this interface. It changes where a program has to be compiled again.
pub const UNTANGLED_ABI_VERSION: u32 = 1;

/// How long a session that is closed waits for the daemon to take note.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// `UNTANGLED_ABI_VERSION` of the library that was linked, to compare with that of the header.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_abi_version() -> u32 {
    UNTANGLED_ABI_VERSION
}

/// Connects to the daemon of a domain, waiting up to `timeout_us` microseconds for it to come up; later requests may
/// take as long. `domain` null is the environment variable `UNTANGLED_DOMAIN`, else `default`.
///
/// # Safety
/// `domain` is null or ends in a zero byte; `client` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_connect(
    domain: *const c_char,
    timeout_us: u64,
    client: *mut ClientHandle,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let (domain, place) = unsafe { (input::text("domain", domain)?, input::place("client", client)?) };
        place.write(ClientHandle::default());
        let options = ClientOptions { domain: domain.map(str::to_owned), timeout: Duration::from_micros(timeout_us) };
        place.write(ClientHandle { id: CLIENTS.add(Client::connect(options)?) });
        Ok(())
    })
}

/// Ends a connection. Its sessions live on.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_disconnect(client: ClientHandle) -> ErrorCode {
    guard(|| CLIENTS.remove(client.id).map(drop))
}

/// Opens a session; everything that `registration` points to is copied.
///
/// # Safety
/// `registration` is null or points to one whose addresses are null or hold as many elements as it says; `session` is
/// null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_register(
    client: ClientHandle,
    registration: *const ClothRegistration,
    session: *mut SessionHandle,
) -> ErrorCode {
    // SAFETY: the caller's promise; no vertex is of a body.
    unsafe { untangled_register_with_body(client, registration, std::ptr::null(), 0, session) }
}

/// Opens a session of which some vertices belong to bodies: the host alone moves them, cloth belongs outside of them,
/// and they get no corrections. A triangle has all of its corners among them, or none; bodies may intersect each other
/// and themselves. A daemon that does not know bodies is `UNTANGLED_REFUSED`. Everything that is pointed to is copied.
///
/// # Safety
/// As `untangled_register`; `body` is null or holds `num_body` vertex indices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_register_with_body(
    client: ClientHandle,
    registration: *const ClothRegistration,
    body: *const u32,
    num_body: usize,
    session: *mut SessionHandle,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("session", session) }?;
        place.write(SessionHandle::default());
        // SAFETY: the caller's promise; one element.
        let registration = unsafe { input::array("registration", registration, 1, 1) }?[0];
        // SAFETY: the caller's promise.
        let mut registration = unsafe { registration.read() }?;
        // SAFETY: the caller's promise.
        registration.body = unsafe { input::array("body", body, num_body, MOST) }?.to_vec();
        let client = CLIENTS.get(client.id)?;
        let opened = lock(&client).register(registration)?;
        place.write(SessionHandle { id: SESSIONS.add(OpenSession::new(opened)) });
        Ok(())
    })
}

/// Ends a session and tells the daemon, which has a second to take note. What the session has lent, positions and
/// corrections, must not be used any more.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_close(session: SessionHandle) -> ErrorCode {
    guard(|| {
        let session = SESSIONS.remove(session.id)?;
        // Another thread that still uses it drops it; then the daemon finds out by itself.
        if let Some(open) = Arc::into_inner(session) {
            open.into_inner().unwrap_or_else(PoisonError::into_inner).close(CLOSE_TIMEOUT);
        }
        Ok(())
    })
}

/// A deadline in microseconds for hosts that have no frame rate to keep: 0.2 s, and 20 microseconds for each triangle;
/// 0 for no session.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_default_deadline_us(session: SessionHandle) -> u64 {
    let mut deadline_us = 0;
    let code = guard(|| {
        let deadline = lock(&*SESSIONS.get(session.id)?).session.default_deadline();
        deadline_us = u64::try_from(deadline.as_micros()).unwrap_or(u64::MAX);
        Ok(())
    });
    if code == ErrorCode::Ok { deadline_us } else { 0 }
}

/// Number of vertices of a session; 0 for no session.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_num_vertices(session: SessionHandle) -> usize {
    let mut num_vertices = 0;
    let code = guard(|| {
        num_vertices = lock(&*SESSIONS.get(session.id)?).session.num_vertices();
        Ok(())
    });
    if code == ErrorCode::Ok { num_vertices } else { 0 }
}

/// Vertices that became one with an earlier one in their place, where a session was registered with `UNTANGLED_WELD`;
/// else 0.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_num_welded_vertices(session: SessionHandle) -> usize {
    let mut num_welded = 0;
    let code = guard(|| {
        num_welded = lock(&*SESSIONS.get(session.id)?).session.num_welded_vertices();
        Ok(())
    });
    if code == ErrorCode::Ok { num_welded } else { 0 }
}

/// How often a session was registered, more than once if a daemon went away; 0 for no session.
#[unsafe(no_mangle)]
pub extern "C" fn untangled_num_registrations(session: SessionHandle) -> u32 {
    let mut num_registrations = 0;
    let code = guard(|| {
        num_registrations = lock(&*SESSIONS.get(session.id)?).session.num_registrations();
        Ok(())
    });
    if code == ErrorCode::Ok { num_registrations } else { 0 }
}

/// Replaces a session's settings from the next frame on; names left out take the daemon's defaults.
///
/// # Safety
/// `settings_json` is null or ends in a zero byte.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_update_settings(
    session: SessionHandle,
    settings_json: *const c_char,
    timeout_us: u64,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let text = unsafe { input::text("settings_json", settings_json) }?;
        let settings = parse(text.ok_or_else(|| input::null("settings_json"))?)?;
        let session = SESSIONS.get(session.id)?;
        lock(&session).session.update_settings(settings, Duration::from_micros(timeout_us))?;
        Ok(())
    })
}

/// The daemon's state as a JSON document (schema `untangled.status/1`) that ends in a zero byte. Its length without
/// that goes to `length`; a `buffer` of `capacity` bytes that is too short is `UNTANGLED_INVALID_ARGUMENT`, and null
/// with 0 asks for the length alone.
///
/// # Safety
/// `buffer` is null or `capacity` bytes may be written there; `length` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn untangled_status(
    client: ClientHandle,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> ErrorCode {
    guard(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { input::place("length", length) }?;
        place.write(0);
        let client = CLIENTS.get(client.id)?;
        let text = lock(&client).status()?.to_string();
        place.write(text.len());
        if buffer.is_null() && capacity == 0 {
            return Ok(());
        }
        if buffer.is_null() {
            return Err(input::null("buffer"));
        }
        if capacity <= text.len() {
            let needed = text.len() + 1;
            return Err(Fault::argument(format_args!("`capacity` is {capacity}; {needed} bytes are needed")));
        }
        // SAFETY: the text and a zero byte fit, as was just checked, by the caller's promise.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr().cast(), buffer, text.len());
            buffer.add(text.len()).write(0);
        }
        Ok(())
    })
}
